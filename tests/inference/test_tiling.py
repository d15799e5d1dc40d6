"""Drawings that repeat, by the model that comes with the package and by one that paints a ramp."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.forms import Form
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.network.tile import Tile
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.shading import curvature_of, occlusion_of
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.picture import Picture
from normalgan.inference.sprites import Sprite
from normalgan.inference.tiling import MOST_TILED
from normalgan.normals import angles
from normalgan.weights.shipped import find_model
from pens import Pixels, overlap


def stones(shape: tuple[int, int] = (128, 128), width: int = 2) -> Pixels:
    """Return a drawing of rings that repeats both ways; some lie across an edge."""
    height, side = shape
    page = np.full((3 * height, 3 * side), 255, np.uint8)
    for x, y, radius in (
        (0.0, 0.3, 0.2),
        (0.45, 0.55, 0.22),
        (0.8, 0.95, 0.24),
        (0.35, 0.05, 0.16),
        (0.9, 0.6, 0.1),
    ):
        for right in range(3):
            for down in range(3):
                at = round((x + right) * side * 16), round((y + down) * height * 16)
                cv2.circle(page, at, round(radius * min(shape) * 16), 0, width, cv2.LINE_AA, 4)
    return page[height : 2 * height, side : 2 * side].copy()


def rolled(picture: Pixels, down: int, right: int) -> Pixels:
    return np.roll(picture, (down, right), (0, 1))


def back(preds: NormalMap, down: int, right: int) -> Floats:
    return np.roll(preds.extended, (-down, -right), (0, 1))


def steps(normals: Floats, axis: int) -> Floats:
    """Return the mean angle between each row or column and the one before; before the first is the last."""
    return np.asarray(angles(normals, np.roll(normals, 1, axis)).mean(1 - axis), np.float32)


@pytest.fixture(scope="module")
def predictor() -> Predictor:
    """The model that comes with the package."""
    return Predictor(OnnxBackend(find_model(), threads=1))


@pytest.fixture(scope="module")
def predicted(predictor: Predictor) -> NormalMap:
    """A drawing that repeats, painted so."""
    return predictor(stones(), tile="both")


@pytest.mark.slow
def test_a_drawing_and_one_that_is_rolled_by_half_are_painted_alike(
    predictor: Predictor, predicted: NormalMap
) -> None:
    other = predictor(rolled(stones(), 64, 64), tile="both")
    apart = angles(predicted.extended, back(other, 64, 64))
    assert apart.mean() < 1
    assert np.percentile(apart, 99) < 5
    # At the seam the map changes as it does in the midst of the other one.
    for axis in (0, 1):
        seam, there = steps(predicted.extended, axis)[0], steps(other.extended, axis)[64]
        assert seam == pytest.approx(there, rel=0.1, abs=0.2)
    alone, other = predictor(stones()), predictor(rolled(stones(), 64, 64))
    assert angles(alone.extended, back(other, 64, 64)).mean() > 10
    assert steps(alone.extended, 1)[0] > 2 * steps(predicted.extended, 1)[0]


@pytest.mark.slow
def test_where_the_edges_are_makes_little_difference(predictor: Predictor, predicted: NormalMap) -> None:
    other = predictor(rolled(stones(), 41, 23), tile="both")
    assert angles(predicted.extended, back(other, 41, 23)).mean() < 6


@pytest.mark.slow
def test_heights_and_shading_go_on_past_the_edges(predicted: NormalMap) -> None:
    turned = (50, 30)
    same = {name: np.roll(getattr(predicted, name), turned, (0, 1)) for name in ("extended", "mask", "alpha")}
    other = replace(predicted, **same)
    one, two = (
        {"height": each.height(), "ao": occlusion_of(each), "curvature": curvature_of(each)}
        for each in (predicted, other)
    )
    for name, values in one.items():
        assert np.abs(np.roll(values, turned, (0, 1)) - two[name]).mean() < 0.02 * np.ptp(values)
    height = predicted.height()
    for axis in (0, 1):
        seam = np.abs(height - np.roll(height, 1, axis))
        assert seam.take(0, axis).mean() < 2 * seam.take(range(120), axis).mean()


def test_nothing_that_is_repeated_rises_on_the_whole(model: Path) -> None:
    everywhere = np.ones((128, 128), bool)
    predicted = Predictor(OnnxBackend(model))(stones(), mask=everywhere, tile="both")
    slope = predicted.extended[..., :2] / predicted.extended[..., 2:]
    assert np.abs(slope.mean((0, 1))).max() < 0.02


@pytest.mark.parametrize(("tile", "shape"), [("x", (96, 160)), ("y", (160, 64)), ("both", (64, 200))])
def test_maps_repeat_in_the_ways_that_are_asked_for(model: Path, tile: Tile, shape: tuple[int, int]) -> None:
    # Where the ramp would end, it would jump.
    everywhere = np.ones(shape, bool)
    predicted = Predictor(OnnxBackend(model))(stones(shape), mask=everywhere, tile=tile)
    assert predicted.extended.shape == (*shape, 3)
    assert predicted.tile == tile
    for axis, there in ((0, tile != "x"), (1, tile != "y")):
        change = steps(predicted.extended, axis)
        assert (change[0] < 2 * change[1:].max()) == there


def test_a_map_of_another_size_repeats_too(model: Path) -> None:
    larger = Predictor(OnnxBackend(model))(stones(), size=301, tile="both")
    assert_repeats(larger, 301)


@pytest.mark.slow
def test_the_map_of_a_drawing_too_large_to_work_on_repeats_too(model: Path) -> None:
    side = MOST_TILED + 35
    large = Predictor(OnnxBackend(model))(stones((side, side), 20), tile="both", mask="outline")
    assert_repeats(large, side)


def assert_repeats(preds: NormalMap, side: int) -> None:
    assert preds.mask.shape == preds.alpha.shape == (side, side)
    assert np.abs(np.linalg.norm(preds.extended, axis=-1) - 1).max() < 1e-5
    for axis in (0, 1):
        change = steps(preds.extended, axis)
        assert change[0] < 2 * change[1:].max()


def test_what_the_lines_enclose_across_an_edge_is_the_object(model: Path) -> None:
    page = np.full((128, 128), 255, np.uint8)
    for x in (0, 128):
        cv2.circle(page, (x, 64), 40, 0, 3, cv2.LINE_AA)
    y, x = np.mgrid[:128, :128] + 0.5
    disc = np.hypot(np.minimum(x, 128 - x), y - 64) < 43
    predicted = Predictor(OnnxBackend(model))(page, tile="x")
    assert overlap(predicted.mask, disc) > 0.95
    assert predicted.warning == ""


def test_of_lines_that_enclose_little_all_is_the_object(model: Path) -> None:
    page = np.full((128, 128), 255, np.uint8)
    page[20::32] = page[21::32] = 0
    predicted = Predictor(OnnxBackend(model))(page, tile="both")
    assert predicted.mask.all()
    assert predicted.warning == ""


def test_opacity_tells_the_object_across_an_edge(model: Path) -> None:
    y, x = np.mgrid[:128, :128] + 0.5
    disc = np.hypot(np.minimum(x, 128 - x), y - 64) < 40
    page = np.full((128, 128, 4), 200, np.uint8)
    page[..., 3] = 255 * disc
    predicted = Predictor(OnnxBackend(model))(page, tile="x")
    assert overlap(predicted.mask, disc) > 0.98
    assert np.abs(predicted.alpha - disc).max() < 0.01


def test_a_hint_at_an_edge_counts_on_both_sides(model: Path) -> None:
    predictor = Predictor(OnnxBackend(model))
    wanted = np.array([0.6, 0.0, 0.8], np.float32)
    hint = [{"x": 0, "y": 64, "normal": [0.6, 0.0, 0.8]}]
    everywhere = np.ones((128, 128), bool)
    predicted = predictor(stones(), hint, everywhere, tile="both")
    assert angles(predicted.extended[64, 0], wanted) < 3
    assert angles(predicted.extended[64, 127], wanted) < 12
    without = predictor(stones(), None, everywhere, tile="both")
    assert angles(without.extended[64, 127], wanted) > 20


@pytest.mark.parametrize(("down", "right"), [(0, 0), (17, 50)])
def test_each_brick_of_a_wall_gets_a_form_also_across_an_edge(
    predictor: Predictor, down: int, right: int
) -> None:
    wall = np.full((128, 128), 255, np.uint8)
    wall[::32] = wall[1::32] = wall[2::32] = 0
    for row in range(4):
        for column in (0, 64):
            wall[32 * row : 32 * row + 32, column + 32 * (row % 2) :][:, :3] = 0
    colour = np.repeat(rolled(wall, down, right)[..., None] / np.float32(255), 3, axis=-1)
    picture = Picture(colour.astype(np.float32), None)
    preds = predictor(picture, tile="both")
    formed = back(Sprite(form=Form("flat", 0.3, 1))(preds, picture), down, right)
    middle, upper, left = formed[19, 32], formed[5, 32], formed[19, 5]
    assert middle[2] > 0.99
    assert upper[1] > 0.5
    assert left[0] < -0.5
    assert formed[96 + 19, 64][2] > 0.99
    assert formed[96 + 19, 37][0] < -0.5


def test_the_way_has_to_be_one_that_there_is(model: Path) -> None:
    with pytest.raises(InputError, match=r"tile is 'xy'; a drawing is repeated along x, y or both\."):
        Predictor(OnnxBackend(model))(stones(), tile="xy")  # type: ignore[arg-type]


def test_hints_off_a_tiles_object_are_told_once_and_where_they_were_given(model: Path) -> None:
    page = np.full((128, 128), 255, np.uint8)
    cv2.circle(page, (64, 64), 40, 0, 3, cv2.LINE_AA)
    hints = [{"x": x, "y": x, "normal": [0, 0, 1]} for x in (64, 4)]
    y, x = np.mgrid[:128, :128] + 0.5
    disc = np.hypot(x - 64, y - 64) < 40
    predicted = Predictor(OnnxBackend(model))(page, hints, disc, tile="both", size=256)
    assert predicted.warning.startswith("1 of 2 hints lies off the object, at x 4, y 4; move it onto it")
