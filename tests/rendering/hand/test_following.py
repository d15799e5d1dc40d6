import numpy as np
import pytest
from ellipsoids import angles, ellipsoid
from matplotlib.path import Path

from normalgan.rendering.hand.distortion import KNOTS, Distortion, follow, random_distortion
from normalgan.rendering.maps import Maps

FLAT = np.zeros((2, KNOTS, KNOTS))
STILL = np.zeros(2)


@pytest.mark.parametrize(
    "inverse",
    [
        [[1.0, 0.0], [0.0, 1.3]],
        [[0.8, 0.0], [0.0, 1.1]],
        [[1.0, 0.3], [0.0, 1.0]],
        [[0.9, -0.25], [0.2, 1.15]],
    ],
)
def test_a_sphere_becomes_the_ellipsoid(inverse: list[list[float]]) -> None:
    matrix = np.array(inverse)
    found = follow(ellipsoid(np.eye(2)), Distortion(matrix, FLAT, 1.0, STILL))
    wanted = ellipsoid(matrix)
    assert angles(ellipsoid(np.eye(2)), wanted).mean() > 5  # not turning them would be seen
    error = angles(found, wanted)
    assert np.median(error) < 0.1
    assert np.percentile(error, 95) < 2.0  # at the rim, where the normal turns by many degrees a pixel
    rim = 3.5 * np.sqrt(wanted.mask.sum())  # pixels, about
    assert (found.mask != wanted.mask).sum() < 0.3 * rim


def test_a_turn_of_the_picture_turns_the_normals() -> None:
    shape = np.array([[0.8, 0.2], [0.0, 1.2]])
    turn = np.deg2rad(25)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    found = follow(ellipsoid(shape), Distortion(rotation, FLAT, 1.0, STILL))
    assert np.median(angles(found, ellipsoid(shape @ rotation))) < 0.1


def test_a_zoom_shows_a_larger_object_of_the_same_shape() -> None:
    found = follow(ellipsoid(np.eye(2)), Distortion(np.eye(2), FLAT, 1.5, np.full(2, -0.25)))
    row, column = np.nonzero(found.mask)
    x, y = ((index + 0.5) / 128 - 0.5 for index in (column, row))
    np.testing.assert_allclose(found.normal[found.mask][:, 0], x / 0.375, atol=0.03)
    np.testing.assert_allclose(found.normal[found.mask][:, 1], -y / 0.375, atol=0.03)
    assert found.mask.sum() == pytest.approx(np.pi * (0.375 * 128) ** 2, rel=0.01)


def test_no_distortion_changes_nothing() -> None:
    maps = ellipsoid(np.array([[0.8, 0.2], [0.0, 1.2]]))
    found = follow(maps, Distortion(np.eye(2), FLAT, 1.0, STILL))
    np.testing.assert_array_equal(found.mask, maps.mask)
    np.testing.assert_allclose(found.normal, maps.normal, atol=1e-6)
    np.testing.assert_array_equal(found.depth, maps.depth)


@pytest.mark.parametrize("seed", range(5))
def test_mask_and_outline_stay_together(seed: int) -> None:
    size = 128
    maps = ellipsoid(np.eye(2), size)
    distortion = random_distortion(0.03, 0.12, maps, np.random.default_rng(seed))
    mask = follow(maps, distortion).mask
    turn = np.linspace(0, 2 * np.pi, 1500)
    outline = size * distortion.move(0.5 + 0.25 * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    x, y = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5)
    centres = np.stack([x.ravel(), y.ravel()], axis=1)
    wrong = Path(outline).contains_points(centres) != mask.ravel()
    away = np.sqrt(((centres[wrong][:, None] - outline[None]) ** 2).sum(axis=-1)).min(axis=1)
    assert away.max(initial=0) < 0.5
    (x, y), (u, v) = outline.T, np.roll(outline, -1, axis=0).T
    length = np.hypot(u - x, v - y).sum()
    assert (mask.sum() - abs((x * v - u * y).sum()) / 2) / length == pytest.approx(0, abs=0.15)  # pixels


def two_walls(size: int = 64) -> Maps:
    """A wall that looks left, beside one that looks right and is nearer, and nothing around."""
    left, right = np.array([-0.8, 0, 0.6]), np.array([0.8, 0, 0.6])
    mask = np.zeros((size, size), bool)
    mask[16:48, 16:48] = True
    normal = np.where((np.arange(size) < 32)[None, :, None], left, right) * mask[..., None]
    depth = np.where(np.arange(size) < 32, 3.0, 2.0) * np.ones((size, 1))
    return Maps(normal.astype(np.float32), np.where(mask, depth, np.inf).astype(np.float32), mask)


def test_surfaces_do_not_mix_with_one_another_nor_with_the_background() -> None:
    shift = np.array([0.4, 0.3]) / 64  # between pixels
    found = follow(two_walls(), Distortion(np.eye(2), FLAT, 1.0, shift))
    normal = found.normal[found.mask]
    leftwards = np.abs(normal - [-0.8, 0, 0.6]).max(axis=1) < 1e-5
    rightwards = np.abs(normal - [0.8, 0, 0.6]).max(axis=1) < 1e-5
    assert (leftwards | rightwards).all()
    np.testing.assert_array_equal(found.depth[found.mask], np.where(leftwards, 3, 2))
    assert leftwards.sum() == pytest.approx(rightwards.sum(), rel=0.05)
    assert np.isinf(found.depth[~found.mask]).all()
    assert not found.normal[~found.mask].any()


@pytest.mark.parametrize("seed", range(3))
def test_normals_are_units_facing_the_viewer(seed: int) -> None:
    maps = ellipsoid(np.eye(2))
    found = follow(maps, random_distortion(0.05, 0.2, maps, np.random.default_rng(seed)))
    assert found.mask.any()
    np.testing.assert_allclose(np.linalg.norm(found.normal[found.mask], axis=1), 1, atol=1e-5)
    assert (found.normal[found.mask][:, 2] > 0).all()
    assert [m.dtype for m in (found.normal, found.depth, found.mask)] == [np.float32, np.float32, bool]


def test_an_object_that_leaves_the_frame_is_cut_off() -> None:
    found = follow(ellipsoid(np.eye(2)), Distortion(np.eye(2), FLAT, 3.0, np.full(2, -1.0)))
    assert found.mask.mean() > 0.99
    assert np.isfinite(found.normal).all()
