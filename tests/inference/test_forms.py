"""Forms against surfaces whose normals are known."""

import numpy as np
import pytest
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.forms import Form, feather, give_form, parse_form

SIDE = 160


def ramp(shape: tuple[int, int]) -> Floats:
    """Return a level map."""
    return np.dstack([np.zeros((*shape, 2)), np.ones(shape)]).astype(np.float32)


def disc(side: int, radius: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
    """Return a disc, and x and y (up) of each pixel from its middle, in radii."""
    y, x = (np.mgrid[:side, :side] - (side - 1) / 2) / radius
    inside = np.hypot(x, y) < 1
    return inside, x.astype(np.float32), -y.astype(np.float32)


def degrees(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.degrees(np.arccos(np.clip((a * b).sum(-1), -1, 1))), np.float32)


@pytest.mark.parametrize("side", [64, SIDE, 700])
def test_a_round_disc_is_a_ball_and_a_hollow_one_the_inside_of_one(side: int) -> None:
    inside, x, y = disc(side, 0.4 * side)
    ball = np.dstack([x, y, np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))])
    dish = np.sin(np.radians(60)) * np.dstack([-x, -y])
    dish = np.dstack([dish, np.sqrt(1 - np.clip((dish**2).sum(-1), 0, 1))])
    within = np.hypot(x, y) < 0.95
    for form, wanted in ((Form("round", 1, 1), ball), (Form("hollow", 1, 1), dish)):
        formed = give_form(ramp(inside.shape), inside, inside.astype(np.float32), form)
        assert degrees(formed, wanted)[within].mean() < (2 if side < 100 else 1.2)
        assert degrees(formed, wanted)[within].max() < 6
        assert np.array_equal(formed[~inside], ramp(inside.shape)[~inside])


@pytest.mark.parametrize("side", [SIDE, 700])
def test_a_flat_disc_has_a_bevel_of_its_width(side: int) -> None:
    inside, x, y = disc(side, 0.4 * side)
    formed = give_form(ramp(inside.shape), inside, inside.astype(np.float32), Form("flat", 0.3, 1))
    away = np.hypot(x, y)
    assert degrees(formed, ramp(inside.shape))[away < 0.55].max() < 1
    slope = degrees(formed, ramp(inside.shape))[(away > 0.8) & (away < 0.97)]
    assert abs(np.median(slope) - 45) < 2
    assert (formed[inside & (x > 0.9), 0] > 0.5).all()  # it leans outwards


def test_a_bevel_leaves_the_middle_level_and_half_a_strength_is_between() -> None:
    inside, x, y = disc(SIDE, 60)
    area = inside.astype(np.float32)
    whole, part = (give_form(ramp(inside.shape), inside, area, Form("round", b, 1)) for b in (1, 0.3))
    away = np.hypot(x, y)
    ring = (away > 0.3) & (away < 0.5)
    slopes = [degrees(each, ramp(inside.shape))[ring].mean() for each in (part, whole)]
    assert slopes[0] < 3
    assert slopes[1] > 20
    half = give_form(ramp(inside.shape), inside, area, Form("round", 1, 0.5))
    between = (whole + ramp(inside.shape)) / 2
    mean = np.asarray(between / np.linalg.norm(between, axis=-1, keepdims=True), np.float32)
    assert degrees(half, mean)[away < 0.9].max() < 0.1
    assert give_form(whole, inside, area, Form("flat", 0.2, 0)) is whole


def test_what_fades_out_has_no_edge() -> None:
    area = np.zeros((SIDE, SIDE), np.float32)
    area[30:130, 20:140] = 1
    faded = feather(area, 0.5)
    assert faded[80, 80] > 0.999
    assert faded[30, 80] < 0.05
    assert faded[10, 10] == 0
    assert np.abs(np.diff(faded, axis=0)).max() < 2 / 25  # it rises over 25 pixels
    assert np.abs(np.diff(faded, 2, axis=0)).max() < 0.02


def test_a_form_in_words_has_the_bevel_and_strength_that_it_names() -> None:
    assert parse_form("Flat,strength=1,bevel=0.1") == Form("flat", 0.1, 1.0)
    assert parse_form("hollow") == Form("hollow", 1.0, 0.7)


@pytest.mark.parametrize(
    "text", ["", "square", "flat,", "flat,bevel=0", "flat,bevel=1.5", "flat,depth=1", "flat,bevel=1.2.3"]
)
def test_what_is_no_form_is_told_with_those_that_are(text: str) -> None:
    with pytest.raises(
        InputError, match=r"form is '.*'; give round, flat or hollow, optionally with a bevel"
    ):
        parse_form(text)
