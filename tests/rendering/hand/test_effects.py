from itertools import pairwise

import numpy as np
import pytest
from ellipsoids import drawing, ellipsoid, rim

from normalgan.rendering.hand.effects import (
    STEP,
    begin_at,
    cut,
    forget,
    in_order,
    inside,
    miss_ends,
    press,
    resample,
    round_off,
    second_pass,
    skip_parts,
    smooth_noise,
    stray,
    turning,
)
from normalgan.rendering.strokes import Stroke


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def line(length: float = 0.625) -> Stroke:
    """Return a level line; its points are those of 200 steps unless another length is given."""
    return resample(Stroke.even(np.array([[0.1, 0.2], [0.1 + length, 0.2]]), 1.5))


CORNERS = np.array([[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]])


def square() -> Stroke:
    return resample(Stroke.even(CORNERS[[0, 1, 2, 3, 0]], 1.0))


def circle() -> Stroke:
    """Return a circle of radius a quarter about the middle."""
    return resample(rim(1))


def test_resampling_keeps_ends_length_and_pressure() -> None:
    corners = np.array([[0.0, 0], [0.4, 0.3], [0.4, 1.0]])
    stroke = Stroke(corners, np.array([1.0, 2, 3]), np.array([1.0, 0.5, 0]))
    fine = resample(stroke)
    assert np.diff(fine.points, axis=0).max() <= STEP + 1e-9
    np.testing.assert_array_equal(fine.points[[0, -1]], stroke.points[[0, -1]])
    assert fine.length == pytest.approx(1.2, rel=0.01)
    assert fine.width[np.abs(fine.points - corners[1]).sum(axis=1).argmin()] == pytest.approx(2, abs=0.02)
    assert circle().closed


def test_a_stroke_of_one_place_can_be_resampled() -> None:
    assert resample(Stroke.even(np.ones((2, 2)), 1.0)).length == 0


def test_turning_adds_up_to_a_full_turn() -> None:
    whole = circle()
    assert turning(whole.points, 1, closed=True)[:-1].sum() == pytest.approx(2 * np.pi, abs=1e-6)
    assert np.median(turning(begin_at(whole, 40).points, 3)) == pytest.approx(3 * STEP / 0.25, rel=0.02)


def test_noise_has_unit_deviation_and_the_wavelength_asked_for() -> None:
    noise = smooth_noise([40000, 40000], 50 * STEP, 2, rng())
    assert noise.shape == (80000, 2)
    assert np.abs(noise.mean()) < 0.05
    assert noise.std() == pytest.approx(1, abs=0.05)
    assert (noise[:, 0] * noise[:, 1]).mean() == pytest.approx(0, abs=0.1)
    one, two = noise[:40000, 0], noise[40000:, 0]
    assert (one * two).mean() == pytest.approx(0, abs=0.1)
    assert (one[:-5] * one[5:]).mean() > 0.9  # a tenth of a wave on
    assert abs((one[:-100] * one[100:]).mean()) < 0.1  # two waves on
    assert np.abs(np.diff(one, 2)).max() < 0.05  # smooth


def test_strokes_share_no_noise() -> None:
    noise = np.array([smooth_noise([2, 2], 10 * STEP, 1, rng(seed))[:, 0] for seed in range(2000)])
    assert (noise[:, 1] * noise[:, 2]).mean() == pytest.approx(0, abs=0.08)


def test_pieces_lie_end_to_end_and_begin_at_corners() -> None:
    cuts = []
    for seed in range(20):
        pieces = cut(square(), 2.0, rng(seed))
        for one, two in pairwise(pieces):
            np.testing.assert_array_equal(one.points[-1], two.points[0])
        np.testing.assert_array_equal(pieces[0].points[0], pieces[-1].points[-1])
        assert sum(piece.length for piece in pieces) == pytest.approx(2.4, rel=1e-6)
        cuts += [piece.points[0] for piece in pieces]
    assert 40 < len(cuts) < 140
    away = np.linalg.norm(np.array(cuts)[:, None] - CORNERS, axis=-1).min(axis=1)
    assert (away < 0.03).mean() > 0.5  # of the square's length, a tenth lies so near a corner


def test_strokes_near_the_silhouette_are_the_outline() -> None:
    strokes = drawing(1)
    shares = inside(strokes, ellipsoid(np.eye(2)))
    assert shares[0] == 0
    assert (shares[1:] > 0.9).all()
    ordered, interior = in_order(strokes[::-1], shares[::-1])
    assert ordered[0] is strokes[0]
    np.testing.assert_array_equal(interior, inside(ordered, ellipsoid(np.eye(2))))


def test_short_strokes_inside_are_forgotten_first() -> None:
    strokes = [line(0.04), line(0.04), line(0.3), line(0.3), line(0.8)]
    interior = np.array([1.0, 0.0, 1.0, 0.0, 1.0])
    kept = np.zeros(5)
    for seed in range(400):
        left = forget(strokes, interior, 0.8, rng(seed))
        kept += [any(stroke is one for one in left) for stroke in strokes]
    assert kept[4] == 400  # the longest
    assert kept[0] < kept[1] < kept[3]
    assert kept[0] < kept[2] < kept[3]
    assert kept[0] == pytest.approx(400 * (1 - 0.8 * np.exp(-0.04 / 0.4)), abs=40)


def test_at_least_one_stroke_is_drawn() -> None:
    dots = [line(1e-6)] * 5
    assert len(forget(dots, np.ones(5), 1.0, rng())) == 1
    assert forget([], np.zeros(0), 1.0, rng()) == []


def test_parts_are_skipped_as_often_as_asked_for() -> None:
    left = [skip_parts(line(), 2.0, rng(seed)) for seed in range(300)]
    assert skip_parts(line(), 0.0, rng())[0].length == pytest.approx(0.625)
    missing = 0.625 - np.mean([sum(stroke.length for stroke in strokes) for strokes in left])
    assert missing == pytest.approx(2 * 0.625 * 0.05, rel=0.35)
    assert all(len(strokes) >= 1 for strokes in left)
    assert all(
        np.isin(stroke.points[:, 0], line().points[:, 0]).all() for strokes in left for stroke in strokes
    )


def test_a_second_pass_of_two_points_has_both() -> None:
    dash = Stroke.even(np.array([[0.1, 0.2], [0.1 + STEP, 0.2]]), 1.5)
    assert all(len(second_pass(dash, rng(seed)).points) == 2 for seed in range(10))


def test_a_second_pass_is_a_part_beside_the_first() -> None:
    for seed in range(30):
        again = second_pass(line(), rng(seed))
        assert 0.38 * 0.625 < again.length <= 0.625 + 1e-9
        assert 0 < abs(again.points[0, 1] - 0.2) < 4 * 0.005


def test_ends_are_too_long_or_too_short_by_the_mean_asked_for() -> None:
    lengths = np.array([miss_ends(line(), 0.03, 0.0, rng(seed)).length for seed in range(600)])
    assert lengths.min() == pytest.approx(0.625)
    assert lengths.mean() - 0.625 == pytest.approx(2 * 0.5 * 0.03, rel=0.2)
    lengths = np.array([miss_ends(line(), 0.0, 0.03, rng(seed)).length for seed in range(600)])
    assert lengths.max() == pytest.approx(0.625)


def test_an_overshoot_goes_straight_on_or_bends_on() -> None:
    straight = miss_ends(line(), 0.06, 0.0, rng(1))
    assert straight.length > 0.628
    np.testing.assert_allclose(straight.points[:, 1], 0.2, atol=1e-9)
    whole = circle()
    arc = Stroke(whole.points[:100], whole.width[:100], whole.darkness[:100])
    longer = miss_ends(arc, 0.08, 0.0, rng(3))
    assert len(longer.points) > 105
    np.testing.assert_allclose(np.hypot(*(longer.points - 0.5).T), 0.25, atol=0.004)


def test_rounding_off_keeps_circles_and_ends_and_takes_detail() -> None:
    rounded = round_off(circle(), 5.0)
    assert rounded.closed
    np.testing.assert_allclose(np.hypot(*(rounded.points - 0.5).T), 0.25, atol=4e-4)
    zigzag = line().points + np.array([0.0, 0.01]) * np.where(np.arange(201) % 4 < 2, 1, -1)[:, None]
    smooth = round_off(Stroke.even(zigzag, 1.0), 5.0)
    np.testing.assert_array_equal(smooth.points[[0, -1]], zigzag[[0, -1]])
    assert np.abs(smooth.points[20:-20, 1] - 0.2).max() < 1e-3
    np.testing.assert_allclose(round_off(line(), 5.0).points, line().points, atol=1e-9)


def test_straying_is_smooth_and_as_far_as_asked_for() -> None:
    strokes = [line()] * 400
    moved = stray(strokes, (0.0, 0.004, 0.0), rng())
    shifts = np.stack([one.points - two.points for one, two in zip(moved, strokes, strict=True)])
    assert shifts.std() == pytest.approx(0.004, rel=0.05)
    assert shifts[:, [0, -1]].std() == pytest.approx(0.004, rel=0.15)  # ends are as free
    assert np.abs(np.diff(shifts, axis=1)).max() < 0.003
    drift = stray(strokes, (0.004, 0.0, 0.0), rng())
    assert np.ptp(drift[0].points[:, 1]) < 4 * 0.004
    assert np.ptp(drift[0].points[:20, 1]) < 0.002


def test_the_pen_is_lifted_slows_down_and_presses() -> None:
    tapered = press([line()], 0.0, 0.0, 0.5, 0.0, rng())[0]
    assert tapered.width[-1] == pytest.approx(0.75, abs=0.02)
    assert tapered.width[0] == pytest.approx(1.125, abs=0.02)
    assert tapered.width[100] == 1.5
    slow = press([square()], 0.0, 0.0, 0.0, 0.3, rng())[0]
    assert slow.width.max() == pytest.approx(1.3)
    assert slow.width[80] == pytest.approx(1.0)
    many = press([line()] * 300, 0.2, 0.3, 0.0, 0.0, rng())
    logs = np.log(np.stack([stroke.width for stroke in many]) / 1.5)
    assert logs.std() == pytest.approx(0.2, rel=0.1)
    darkness = np.stack([stroke.darkness for stroke in many])
    assert darkness.max() <= 1
    assert (darkness < 1).mean() == pytest.approx(0.5, abs=0.05)
