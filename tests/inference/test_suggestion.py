import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from normalgan.arrays import Floats
from normalgan.inference.suggestion import Point, suggest, uncertainty

NONE = np.empty((0, 2), np.float32)


def disc(size: int = 128) -> tuple[Floats, NDArray[np.bool_]]:
    """Return a flat disc that faces the viewer."""
    y, x = np.mgrid[:size, :size] + 0.5
    mask = np.hypot(x - size / 2, y - size / 2) < 0.4 * size
    return np.broadcast_to(np.array([0, 0, 1], np.float32), (size, size, 3)).copy(), mask


def places(points: list[Point]) -> Floats:
    return np.array([(point.x, point.y) for point in points], np.float32)


@pytest.mark.parametrize("kappa", [0.02, 0.5, 1.0, 3.0, 20.0])
def test_doubt_is_the_mean_angle_of_the_density(kappa: float) -> None:
    def weight(angle: float) -> float:
        return float(np.sin(angle) * np.exp(-kappa * angle))

    mean = quad(lambda angle: angle * weight(angle), 0, np.pi)[0] / quad(weight, 0, np.pi)[0]
    assert uncertainty(np.array([kappa], np.float32))[0] == pytest.approx(mean / (np.pi / 2), rel=1e-4)


def test_the_first_point_is_where_the_model_is_in_doubt() -> None:
    normals, mask = disc()
    confidence = np.full(mask.shape, 50, np.float32)
    confidence[40:52, 80:92] = 1
    points = suggest(normals, mask, confidence, NONE, 5)
    assert np.hypot(points[0].x - 86, points[0].y - 46) < 6
    assert points[0].gain > 2 * points[1].gain


def test_without_confidence_the_first_points_are_where_it_bends() -> None:
    normals, mask = disc()
    normals[:, 50:] = (0.6, 0, 0.8)
    points = suggest(normals, mask, None, NONE, 3)
    assert np.abs(places(points)[:2, 0] - 50).max() < 6
    assert np.ptp(places(points)[:2, 1]) > 20


def test_points_are_apart_on_the_object_and_cover_it() -> None:
    normals, mask = disc()
    points = suggest(normals, mask, np.ones(mask.shape, np.float32), NONE, 12)
    at = places(points)
    assert 8 <= len(at) <= 12
    between = np.linalg.norm(at[:, None] - at[None], axis=-1)
    np.fill_diagonal(between, np.inf)
    assert between.min() > 14
    assert all(mask[int(y), int(x)] for x, y in at)
    rows, columns = np.nonzero(mask)
    nearest = np.linalg.norm(np.stack([columns, rows], 1)[:, None] + 0.5 - at, axis=-1).min(1)
    assert nearest.max() < 2.2 * between.min()


def test_no_point_is_beside_a_hint() -> None:
    normals, mask = disc()
    confidence = np.full(mask.shape, 50, np.float32)
    confidence[40:52, 80:92] = 1
    taken = np.array([[86, 46]], np.float32)
    points = suggest(normals, mask, confidence, taken, 5)
    assert points
    assert np.linalg.norm(places(points) - taken, axis=1).min() > 10


def test_a_large_map_has_the_points_of_a_small_one() -> None:
    normals, mask = disc(128)
    normals[:, 50:] = (0.6, 0, 0.8)
    large = np.kron(mask, np.ones((8, 8), bool))
    points = suggest(np.kron(normals, np.ones((8, 8, 1), np.float32)), large, None, NONE, 4)
    small = suggest(normals, mask, None, NONE, 4)
    assert np.linalg.norm(places(points)[0] / 8 - places(small)[0]) < 12
    assert all(large[int(point.y), int(point.x)] for point in points)
    assert all(point.normal == pytest.approx((0.6, 0, 0.8)) or point.normal == (0, 0, 1) for point in points)


def test_a_thread_of_an_object_still_has_points() -> None:
    normals, _ = disc(600)
    mask = np.zeros((600, 600), bool)
    mask[299:301, 50:550] = True
    points = suggest(normals, mask, None, NONE, 3)
    assert points
    assert all(mask[int(point.y), int(point.x)] for point in points)
    assert suggest(normals, np.zeros_like(mask), None, NONE, 3) == []
    speck = np.zeros_like(mask)
    speck[300, 300] = True  # less than a pixel where points are looked for
    assert len(suggest(normals, speck, None, NONE, 3)) <= 1


def test_points_keep_off_the_lines() -> None:
    normals = np.zeros((256, 256, 3), np.float32)
    normals[:, :128], normals[:, 128:] = (-0.6, 0, 0.8), (0.6, 0, 0.8)
    mask, lines = np.zeros((256, 256), bool), np.zeros((256, 256), bool)
    mask[20:236, 20:236] = lines[20:236, 126:130] = True
    assert 120 < suggest(normals, mask, None, NONE, 1)[0].x < 136  # the ridge is what bends
    points = suggest(normals, mask, None, NONE, 6, lines)
    assert len(points) == 6
    assert all(abs(point.x - 128) > 5 for point in points)
    assert suggest(normals, mask, None, NONE, 1, mask)  # where all is ink, there is nothing to keep off
