import numpy as np
import pytest
from skimage.measure import find_contours

from normalgan.rendering.strokes import resample, settle, smooth


def circle(radius: float, centre: tuple[float, float], side: int = 200) -> np.ndarray:
    """Return the border of a disc on a grid, as (x, y) between the centres of its pixels: stairs."""
    x, y = np.meshgrid(np.arange(side) - centre[0], np.arange(side) - centre[1])
    (contour,) = find_contours((x * x + y * y < radius**2).astype(float), 0.5)
    return np.asarray(contour)[:, ::-1] - centre


@pytest.mark.parametrize("radius", [12.0, 40.3, 85.7])
def test_the_stairs_of_a_disc_settle_on_its_circle(radius: float) -> None:
    stairs = circle(radius, (99.7, 100.2))
    settled = settle(stairs, 4.0, 0.5)
    off = np.hypot(*settled.T) - radius
    assert np.abs(off).mean() < 0.1
    assert np.abs(np.hypot(*stairs.T) - radius).mean() > 0.19
    assert abs(off.mean()) < 0.02  # a Gaussian alone would shrink the smallest by 0.7
    np.testing.assert_array_equal(settled[0], settled[-1])


def test_the_stairs_of_a_slanted_line_settle_on_the_line() -> None:
    x = np.arange(100.0)
    stairs = np.stack([x, np.rint(0.3 * x)], axis=1)
    settled = settle(stairs, 4.0, 0.5)
    off = np.abs(settled[:, 1] - 0.3 * settled[:, 0])[8:-8]
    assert off.max() < 0.15


def test_a_corner_stays_a_corner() -> None:
    leg = np.arange(0.0, 40.0)
    corner = np.concatenate([np.stack([leg, 0 * leg], 1), np.stack([40 + 0 * leg, leg], 1)])
    assert np.hypot(*(settle(corner, 4.0, 0.5) - [40, 0]).T).min() < 1.1
    assert np.hypot(*(smooth(corner, 8.0) - [40, 0]).T).min() > 1.5


@pytest.mark.parametrize("count", [2, 3, 5, 50])
def test_ends_stay_and_straight_lines_too(count: int) -> None:
    line = np.linspace([3.0, 1.0], [40.0, 9.0], count)
    np.testing.assert_allclose(smooth(line, 3.0), line, atol=1e-9)
    bent = line + np.random.default_rng(0).normal(size=line.shape)
    np.testing.assert_allclose(smooth(bent, 3.0)[[0, -1]], bent[[0, -1]])


def test_points_are_set_at_equal_distances() -> None:
    turn = np.linspace(0, 2 * np.pi, 1000)
    ring = 20 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    ring[-1] = ring[0]
    spaced = resample(ring, 1.0)
    steps = np.hypot(*np.diff(spaced, axis=0).T)
    assert len(steps) == round(40 * np.pi)
    np.testing.assert_allclose(steps, 1.0, rtol=0.01)
    np.testing.assert_array_equal(spaced[0], spaced[-1])
    assert len(resample(ring / 1000, 1.0)) == 4  # a closed line keeps three sides
