import numpy as np
import pytest

from normalgan.rendering.strokes import Stroke, rasterise


def exact(a: tuple[float, float], b: tuple[float, float], width: float, size: int) -> np.ndarray:
    """Return the coverage of each pixel by a bar with round ends, from 32 × 32 samples a pixel."""
    fine = (np.arange(32 * size) + 0.5) / 32
    x, y = np.meshgrid(fine, fine)
    way = np.subtract(b, a)
    at = np.clip(((x - a[0]) * way[0] + (y - a[1]) * way[1]) / (way @ way), 0, 1)
    inside = np.hypot(x - a[0] - at * way[0], y - a[1] - at * way[1]) < width / 2
    return np.asarray(inside.reshape(size, 32, size, 32).mean((1, 3)))


@pytest.mark.parametrize("width", [0.3, 1.0, 1.25, 2.6])
@pytest.mark.parametrize("place", [8.0, 8.25, 8.5])
def test_an_upright_bar_covers_what_it_covers(width: float, place: float) -> None:
    ink = rasterise([Stroke.even(np.array([[place, -9.0], [place, 30.0]]), width)], 16)
    left, right = (
        np.maximum(place - width / 2, np.arange(16)),
        np.minimum(place + width / 2, np.arange(1, 17)),
    )
    np.testing.assert_allclose(ink, np.broadcast_to(np.maximum(right - left, 0), (16, 16)), atol=0.01)


@pytest.mark.parametrize("width", [0.75, 1.25, 3.0, 7.0])
@pytest.mark.parametrize("end", [(26.0, 7.0), (25.0, 24.0), (12.0, 27.5)])
def test_a_slanted_bar_covers_its_area(width: float, end: tuple[float, float]) -> None:
    start = (7.3, 6.1)
    ink = rasterise([Stroke.even(np.array([start, end]), width)], 32)
    truth = exact(start, end, width, 32)
    area = width * np.hypot(end[0] - start[0], end[1] - start[1])
    assert ink.sum() == pytest.approx(area + np.pi * width**2 / 4, rel=0.02)
    assert np.abs(ink - truth).max() < 0.12  # at the ends; along the line it is exact
    assert np.abs(ink - truth).mean() < 0.002


def test_width_and_darkness_change_along_a_stroke() -> None:
    points = np.stack([np.linspace(5, 95, 10), np.full(10, 50.3)], axis=1)
    ink = rasterise([Stroke(points, np.linspace(1, 7, 10), np.linspace(1, 0.25, 10))], 100)
    share = (np.arange(10, 90) + 0.5 - 5) / 90
    np.testing.assert_allclose(ink[:, 10:90].sum(axis=0), (1 + 6 * share) * (1 - 0.75 * share), rtol=0.04)
    np.testing.assert_allclose(ink[50, 10:90], 1 - 0.75 * share, atol=0.03)


def test_the_ink_does_not_depend_on_the_points_of_a_stroke() -> None:
    ends = np.array([[3.2, 4.1], [57.0, 33.3]])
    few = Stroke(ends, np.array([1.0, 4.0]), np.array([1.0, 0.5]))
    share = np.linspace(0, 1, 200)
    many = Stroke(ends[0] + share[:, None] * (ends[1] - ends[0]), 1 + 3 * share, 1 - 0.5 * share)
    np.testing.assert_allclose(rasterise([few], 64), rasterise([many], 64), atol=2e-2)


def test_a_stroke_covers_a_pixel_once_and_two_strokes_darken_each_other() -> None:
    way = np.array([[4.0, 8.0], [28.0, 8.0]])
    once = rasterise([Stroke.even(way, 2.0, 0.5)], 32)
    back = Stroke.even(np.concatenate([way, way[:1]]), 2.0, 0.5)
    np.testing.assert_allclose(rasterise([back], 32), once, atol=1e-6)
    assert back.closed
    twice = rasterise([Stroke.even(way, 2.0, 0.5)] * 2, 32)
    np.testing.assert_allclose(twice, 1 - (1 - once) ** 2, atol=1e-6)


def test_moving_by_whole_pixels_moves_the_ink() -> None:
    rng = np.random.default_rng(3)
    points = 20 + rng.uniform(-8, 8, (12, 2))
    here = rasterise([Stroke.even(points, 1.4)], 48)
    there = rasterise([Stroke.even(points + np.array([5, -3]), 1.4)], 48)
    np.testing.assert_allclose(np.roll(here, (-3, 5), (0, 1)), there, atol=1e-5)


def test_the_frame_cuts_off_what_is_outside() -> None:
    points = np.array([[-400.0, 10.0], [500.0, 22.0], [40.0, -300.0], [5.0, 5.0]])
    stroke = Stroke.even(points, 3.0)
    moved = Stroke.even(points + 40, 3.0)
    np.testing.assert_allclose(rasterise([stroke], 24), rasterise([moved], 104)[40:64, 40:64], atol=1e-5)
    assert rasterise([Stroke.even(points[:2] + np.array([0, 900]), 3.0)], 24).max() == 0


def test_no_strokes_leave_blank_paper_and_a_dot_is_drawn() -> None:
    assert rasterise([], 8).max() == 0
    dot = rasterise([Stroke.even(np.array([[4.0, 4.0], [4.0, 4.0]]), 3.0)], 8)
    assert dot.sum() == pytest.approx(np.pi * 9 / 4, rel=0.1)


def test_ink_is_float32_within_0_and_1_and_always_the_same() -> None:
    rng = np.random.default_rng(0)
    strokes = [
        Stroke(rng.uniform(0, 64, (20, 2)), rng.uniform(0, 30, 20), rng.uniform(0, 1, 20)) for _ in range(6)
    ]
    ink = rasterise(strokes, 64)
    assert ink.dtype == np.float32
    assert ink.min() >= 0
    assert ink.max() <= 1
    np.testing.assert_array_equal(ink, rasterise(strokes, 64))
