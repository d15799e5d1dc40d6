from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from ellipsoids import drawing, ellipsoid

from normalgan.rendering.hand import Hand
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes import Stroke

MAPS = ellipsoid(np.eye(2))
FULL = Hand(strength=(1.0, 1.0))
SETTINGS = [field.name for field in fields(Hand)[1:-1]]
NONE: dict[str, Any] = dict.fromkeys(SETTINGS, 0.0)
STILL = Hand(strength=(1.0, 1.0), pen=(1.0, 1.0), **NONE)


def draw(hand: Hand, seed: int = 0, size: int = 128) -> tuple[list[Stroke], Maps]:
    maps = MAPS if size == 128 else ellipsoid(np.eye(2), size)
    return hand.draw(drawing(size), maps, np.random.default_rng(seed))


def same(one: list[Stroke], two: list[Stroke]) -> bool:
    return len(one) == len(two) and all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for a, b in zip(one, two, strict=True)
        for name in ("points", "width", "darkness")
    )


@pytest.mark.parametrize("hand", [replace(FULL, strength=(0.0, 0.0)), STILL], ids=["strength", "settings"])
def test_strength_0_is_the_exact_drawing_bit_for_bit(hand: Hand) -> None:
    strokes, maps = draw(hand)
    assert same(strokes, drawing())
    assert maps is MAPS


def test_the_same_generator_draws_the_same() -> None:
    assert same(draw(FULL, 3)[0], draw(FULL, 3)[0])
    assert not same(draw(FULL, 3)[0], draw(FULL, 4)[0])


@pytest.mark.parametrize("setting", SETTINGS)
def test_every_setting_has_an_effect(setting: str) -> None:
    value = 0.3 if setting in {"proportion", "pressure", "fade", "taper", "slowness"} else 1.0
    value = 0.02 if setting in {"distortion", "simplification", "drift", "wobble", "tremor"} else value
    value = (
        0.05 if setting in {"overshoot", "gaps"} else 6.0 if setting in {"cuts", "missed_parts"} else value
    )
    strokes, maps = draw(Hand((1.0, 1.0), pen=(1.0, 1.0), **{**NONE, setting: value}))
    resampled = draw(replace(STILL, tremor=1e-12))[0]
    assert not same(strokes, resampled)
    shapes = [stroke.points.shape for stroke in strokes]
    if shapes == [stroke.points.shape for stroke in resampled]:
        pairs = zip(strokes, resampled, strict=True)
        moved = max(np.abs(one.points - two.points).max() for one, two in pairs)
    else:
        moved = np.inf
    if setting in {"pressure", "fade", "taper", "slowness"}:
        assert moved < 1e-6
    else:
        assert moved > 0.1
    assert (maps is MAPS) == (setting not in {"distortion", "proportion"})


@pytest.mark.parametrize("seed", range(3))
def test_a_drawing_four_times_as_large_is_drawn_alike(seed: int) -> None:
    hand = replace(FULL, distortion=0.0, proportion=0.0, missed=0.0)  # what is inside is known by pixels
    small, large = draw(hand, seed, 64)[0], draw(hand, seed, 256)[0]
    assert len(small) == len(large)
    for one, two in zip(small, large, strict=True):
        np.testing.assert_allclose(4 * one.points, two.points, atol=1e-6)
        np.testing.assert_allclose(one.width, two.width)


def test_one_effect_does_not_shift_another() -> None:
    some, other = draw(FULL, 1), draw(replace(FULL, fade=0.0, slowness=0.0), 1)
    assert len(some[0]) == len(other[0])
    for one, two in zip(some[0], other[0], strict=True):
        np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(some[1].normal, draw(replace(FULL, wobble=0.0), 1)[1].normal)


def test_strokes_stay_with_the_maps_under_distortion() -> None:
    strokes, maps = draw(replace(STILL, distortion=0.04, proportion=0.2), 2)
    assert not np.array_equal(maps.mask, MAPS.mask)
    x, y = strokes[0].points.T  # the outline
    for factor, on in ((0.95, True), (1.05, False)):
        column, row = ((64 + factor * (at - 64)).astype(int) for at in (x, y))
        assert (maps.mask[row, column] == on).mean() > 0.97


def test_strength_scales_the_errors() -> None:
    hand = replace(STILL, drift=0.01, wobble=0.01)
    exact, off = draw(replace(STILL, tremor=1e-12))[0], []
    for strength in (0.1, 0.4, 1.0):
        far = [
            np.abs(a.points - b.points).mean()
            for seed in range(10)
            for a, b in zip(draw(replace(hand, strength=(strength, strength)), seed)[0], exact, strict=True)
        ]
        off.append(np.mean(far))
    assert off[0] == pytest.approx(0.1 * off[2], rel=0.01)
    assert off[1] == pytest.approx(0.4 * off[2], rel=0.01)


def test_the_pen_is_as_wide_as_its_range_says() -> None:
    hand = replace(STILL, pen=(0.5, 3.0))
    factors = [draw(hand, seed)[0][0].width[0] / 1.25 for seed in range(100)]
    assert 0.5 <= min(factors) < 0.7
    assert 2.4 < max(factors) <= 3
    assert np.median(factors) == pytest.approx(np.sqrt(1.5), rel=0.25)
    narrow = replace(hand, strength=(0.5, 0.5))
    assert max(draw(narrow, seed)[0][0].width[0] / 1.25 for seed in range(50)) <= np.sqrt(3)


@pytest.mark.parametrize("seed", range(6))
def test_the_hand_draws_finite_strokes_and_at_least_one(seed: int) -> None:
    wild = Hand(
        (1.0, 1.0),
        0.1,
        0.3,
        20.0,
        0.1,
        1.0,
        20.0,
        1.0,
        0.1,
        0.1,
        0.1,
        0.1,
        0.1,
        1.0,
        2.0,
        0.95,
        2.0,
        (0.1, 10.0),
    )
    strokes, maps = draw(wild, seed)
    assert strokes
    for stroke in strokes:
        assert np.isfinite(stroke.points).all()
        assert (stroke.width > 0).all()
        assert ((stroke.darkness >= 0) & (stroke.darkness <= 1)).all()
    assert maps.mask.any()


def test_an_empty_drawing_stays_empty() -> None:
    strokes, maps = FULL.draw([], MAPS, np.random.default_rng(0))
    assert strokes == []
    assert maps.mask.any()
    empty = Maps(np.zeros_like(MAPS.normal), np.full_like(MAPS.depth, np.inf), np.zeros_like(MAPS.mask))
    dot = Stroke.even(np.full((2, 2), 40.0), 1.0)
    strokes, maps = FULL.draw([dot], empty, np.random.default_rng(0))
    assert len(strokes) >= 1
    assert not maps.mask.any()
