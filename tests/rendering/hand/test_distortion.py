import numpy as np
import pytest
from ellipsoids import ellipsoid

from normalgan.rendering.hand.distortion import KNOTS, Distortion, random_distortion

SPHERE = ellipsoid(np.eye(2), 96)


def any_distortion(seed: int, bend: float = 0.03, proportion: float = 0.1) -> Distortion:
    return random_distortion(bend, proportion, SPHERE, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(4))
def test_moving_undoes_the_sources(seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.05, 1.05, (200, 2))
    distortion = any_distortion(seed)
    moved = distortion.move(points)
    assert np.abs(moved - points).max() > 0.01
    np.testing.assert_allclose(distortion.sources(moved)[0], points, atol=1e-7)


def test_the_jacobian_is_that_of_the_sources() -> None:
    distortion, step = any_distortion(1), 1e-6
    points = np.random.default_rng(0).uniform(0, 1, (50, 2))
    for axis in (0, 1):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        slope = (distortion.sources(ahead)[0] - distortion.sources(behind)[0]) / (2 * step)
        np.testing.assert_allclose(distortion.sources(points)[1][:, :, axis], slope, atol=1e-7)


def test_the_grid_is_the_sources_of_the_pixels() -> None:
    distortion = any_distortion(2)
    place, jacobian = distortion.grid(30, 40)
    x, y = np.meshgrid((np.arange(40) + 0.5) / 40, (np.arange(30) + 0.5) / 40)
    source, slopes = distortion.sources(np.stack([x.ravel(), y.ravel()], axis=1))
    np.testing.assert_allclose(place.reshape(2, -1).T, source, atol=1e-12)
    np.testing.assert_allclose(
        jacobian.reshape(2, 2, -1).transpose(2, 0, 1) / distortion.zoom, slopes, atol=1e-12
    )


@pytest.mark.parametrize("seed", range(12))
def test_nothing_folds_over_even_at_the_limits(seed: int) -> None:
    _, jacobian = any_distortion(seed, bend=0.1, proportion=0.3).grid(200, 200)
    assert (jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]).min() > 0.05


def test_displacements_are_as_large_as_asked_for() -> None:
    moves = []
    for seed in range(300):
        rng = np.random.default_rng(seed)
        bends = random_distortion(0.01, 0.0, SPHERE, rng).bends
        moves.append(Distortion(np.eye(2), bends, 1.0, np.zeros(2)).sources(np.array([[0.4, 0.55]]))[0])
    assert np.std(moves, axis=0) == pytest.approx(0.01, rel=0.25)


@pytest.mark.parametrize("seed", range(4))
def test_the_object_stays_centred_and_as_large(seed: int) -> None:
    turn = np.linspace(0, 2 * np.pi, 2000)
    outline = 0.5 + 0.25 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    moved = any_distortion(seed).move(outline)
    low, high = moved.min(axis=0), moved.max(axis=0)
    np.testing.assert_allclose((low + high) / 2, 0.5, atol=0.01)  # a pixel: the object is known by its pixels
    assert (high - low).max() == pytest.approx(0.5, abs=0.015)


def test_an_empty_map_can_be_distorted() -> None:
    empty = ellipsoid(1e3 * np.eye(2), 32)
    assert not empty.mask.any()
    distortion = random_distortion(0.02, 0.1, empty, np.random.default_rng(0))
    assert distortion.zoom == 1
    assert distortion.bends.shape == (2, KNOTS, KNOTS)
