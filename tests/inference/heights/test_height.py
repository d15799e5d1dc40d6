import time

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from normalgan.animals import Animal
from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.heights.height import integrate
from normalgan.inference.heights.height_pyramid import double, halve
from normalgan.normals import normalize
from normalgan.rendering import EmbreeRenderer
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.view import View


def ellipsoid(size: int, a: float, b: float, c: float) -> tuple[Floats, BoolMask, Floats]:
    """Normals, mask and height in pixels of the front of an ellipsoid, in units of half the frame."""
    along = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(along, -along)
    inside = 1 - (x / a) ** 2 - (y / b) ** 2
    z = c * np.sqrt(np.maximum(inside, 0))
    normals = normalize(np.stack([x / a**2, y / b**2, z / c**2], axis=-1))
    return normals, inside > 0, (z * size / 2).astype(np.float32)


def scale(found: NDArray[np.floating], true: NDArray[np.floating]) -> tuple[float, float]:
    """Slope of the line that explains the found heights by the true ones, and the correlation."""
    slope = np.polyfit(true.astype(np.float64), found.astype(np.float64), 1)[0]
    return float(slope), float(np.corrcoef(found, true)[0, 1])


@pytest.mark.parametrize("axes", [(0.9, 0.9, 0.9), (0.8, 0.5, 0.3), (0.5, 0.8, 0.7)])
@pytest.mark.parametrize("jumps", [0.0, 2.0])
def test_an_ellipsoid_returns_to_its_height(axes: tuple[float, float, float], jumps: float) -> None:
    normals, mask, true = ellipsoid(96, *axes)
    found = integrate(normals, mask, jumps)
    assert found.dtype == np.float32
    slope, correlation = scale(found[mask], true[mask])
    assert slope == pytest.approx(1, abs=0.02)
    assert correlation > 0.999
    assert abs(found[mask].mean()) < 1e-3
    assert not found[~mask].any()


def test_a_cap_is_exact_to_a_tenth_of_a_pixel() -> None:
    normals, _, true = ellipsoid(128, 1, 1, 1)
    y, x = np.indices(true.shape)
    mask = np.hypot(x - 63.5, y - 63.5) < 45
    found = integrate(normals, mask)
    assert np.abs(found - (true - true[mask].mean()))[mask].max() < 0.1


@pytest.mark.parametrize(("rows", "columns", "most"), [(48, 64, 0.8), (160, 160, 2.0)])
def test_two_planes_keep_the_step_between_them_and_plain_poisson_smears_it(
    rows: int, columns: int, most: float
) -> None:
    # Side by side, one rising and one falling upwards: like open scissors, a step that grows to both ends.
    slope = 0.4
    y, x = np.indices((rows, columns)).astype(np.float64)
    rise = np.where(x < columns / 2, slope, -slope)
    normals = normalize(np.stack([np.zeros_like(x), -rise, np.ones_like(x)], axis=-1))
    true = rise * (rows / 2 - 0.5 - y)
    mask = np.ones((rows, columns), dtype=bool)
    kept, smeared = integrate(normals, mask), integrate(normals, mask, jumps=0)

    def errors(height: Floats) -> tuple[float, float]:
        """Largest error of a height, and of the step over the one column where the planes meet."""
        step = np.diff(height, axis=1)[:, columns // 2 - 1] + 2 * slope * (rows / 2 - 0.5 - y[:, 0])
        return float(np.abs(height - true).max()), float(np.abs(step).max())

    assert max(errors(kept)) < most  # of a step of up to 19 and 64
    assert min(errors(smeared)) > 4


def test_parts_have_a_mean_of_their_own_and_holes_stay_holes() -> None:
    normals, mask, true = ellipsoid(64, 0.9, 0.9, 0.9)
    y, x = np.indices(mask.shape)
    holed = mask & (np.hypot(x - 30, y - 40) > 7)
    left, right = holed & (x < 31), holed & (x > 32)
    found = integrate(normals, left | right)
    for part in (left, right):
        assert abs(found[part].mean()) < 1e-3
        assert np.abs(found - (true - true[part].mean()))[part].mean() < 0.4
    assert not found[~(left | right)].any()


def test_normals_that_face_away_or_are_unknown_do_no_harm() -> None:
    normals, mask, true = ellipsoid(64, 0.8, 0.8, 0.5)
    broken = normals.copy()
    broken[30:34, 30:34] = 0
    broken[20, 20] = (0.8, 0.0, -0.6)
    found = integrate(broken, mask)
    assert np.isfinite(found).all()
    slope, correlation = scale(found[mask], true[mask])
    assert slope == pytest.approx(1, abs=0.05)
    assert correlation > 0.99


def test_a_single_pixel_and_an_empty_mask() -> None:
    facing = np.broadcast_to(np.array([0, 0, 1], np.float32), (5, 5, 3)).copy()
    one = np.zeros((5, 5), dtype=bool)
    assert not integrate(facing, one).any()
    one[2, 2] = True
    assert not integrate(facing, one).any()


def mug(size: int, soft: float) -> tuple[Floats, BoolMask, NDArray[np.float64]]:
    """Normals of a mug that is seen from above, its mask, each pixel's distance from its front rim.

    The normals on both sides of the rim are blended, as a network's are.
    """
    y, x = np.mgrid[:size, :size] / size
    across = (x - 0.5) / 0.3
    opening = across**2 + ((y - 0.3) / 0.1) ** 2 < 1
    body = (np.abs(across) < 1) & (y > 0.3) & (y < 0.8 + 0.1 * np.sqrt(np.maximum(1 - across**2, 0)))
    lean = np.where(opening, -across, across).clip(-0.98, 0.98)
    depth = np.sqrt(1 - lean**2)
    up = np.where(opening, -0.3, 0.3)
    normals = normalize(np.stack([lean, up * depth, depth], -1).astype(np.float32))
    mask = opening | body
    blurred = cv2.GaussianBlur(np.where(mask[..., None], normals, 0), (0, 0), soft)
    normals = normalize(np.asarray(blurred, np.float32))
    rim = (np.abs(across) <= 1) & (np.abs(y - 0.3 - 0.1 * np.sqrt(np.maximum(1 - across**2, 0))) < 1 / size)
    return normals, mask, ndimage.distance_transform_edt(~rim)


@pytest.mark.parametrize("size", [256, 512])
def test_a_mug_breaks_at_its_rim_and_nowhere_else(size: int) -> None:
    normals, mask, away = mug(size, size / 200)
    height = integrate(normals, mask)
    inner = ndimage.binary_erosion(mask, iterations=size // 40)
    # Second differences: what is not at a break is smooth.
    bends = np.abs(np.diff(height, 2, axis=0))[:, 1:-1] + np.abs(np.diff(height, 2, axis=1))[1:-1]
    beside = (inner & (away > size / 64))[1:-1, 1:-1]
    assert np.count_nonzero(beside & (bends > 2.5)) == 0


@pytest.mark.parametrize("size", [128, 256])
def test_the_inner_wall_of_a_mug_does_not_break_to_the_front_of_its_rim(size: int) -> None:
    normals, mask, away = mug(size, size / 200)
    rim = ndimage.binary_erosion(mask, iterations=3) & (away <= size / 64)

    def rise(height: Floats) -> float:
        """Return the largest step to the front from a pixel at the rim to the one above it."""
        return float((height[:-1] - height[1:])[rim[:-1] & rim[1:]].max())

    assert rise(integrate(normals, mask)) < 1.5 * rise(integrate(normals, mask, jumps=0))


def test_an_animal_with_legs_before_its_body_returns_to_its_depth() -> None:
    mesh = Animal("fox", 5).load()
    camera = framed(mesh.vertices, look_at_origin(60, 15, 0), None, 0.06)
    maps = View(mesh, camera, EmbreeRenderer(), 128).maps()
    true = -maps.depth[maps.mask] * 128 / (camera.window[1] - camera.window[0])
    bilateral = scale(integrate(maps.normal, maps.mask)[maps.mask], true)
    poisson = scale(integrate(maps.normal, maps.mask, jumps=0)[maps.mask], true)
    assert bilateral[1] > 0.95
    assert bilateral[1] > poisson[1]
    assert 0.8 < bilateral[0] < 1.1


def test_it_takes_under_a_second_of_the_processor_at_256() -> None:
    normals, mask, _ = ellipsoid(256, 0.9, 0.9, 0.9)
    integrate(normals[:8, :8], np.ones((8, 8), dtype=bool))  # imports
    start = time.process_time()
    integrate(normals, mask)
    assert time.process_time() - start < 1


def test_what_cannot_be_integrated_is_refused() -> None:
    normals, mask, _ = ellipsoid(16, 0.9, 0.9, 0.9)
    with pytest.raises(InputError, match=r"normals of shape \(16, 16, 2\) do not match a mask of \(16, 16\)"):
        integrate(normals[..., :2], mask)
    normals[8, 8] = np.nan
    with pytest.raises(InputError, match="is not finite"):
        integrate(normals, mask)


def test_half_the_size_and_back_lies_on_the_same_plane() -> None:
    y, x = np.indices((7, 10)).astype(np.float64)
    plane = 0.3 * x - 0.2 * y
    normal = normalize(np.array([-0.3, -0.2, 1.0])).astype(np.float64)
    normals = np.broadcast_to(normal, (7, 10, 3)).copy()
    half, mask = halve(normals, np.ones((7, 10), dtype=bool))
    assert mask.shape == (4, 5)
    assert np.allclose(half, normal)
    # The middles of pixels of half the size, which are twice as far apart and as high.
    coarse = (0.3 * (2 * np.arange(5)[None] + 0.5) - 0.2 * (2 * np.arange(4)[:, None] + 0.5)) / 2
    assert np.allclose(double(coarse, normals), plane)


def rolling(rows: int, columns: int) -> tuple[Floats, Floats]:
    """Normals and height in pixels of hills that repeat both ways."""
    y, x = np.mgrid[:rows, :columns] + 0.5
    x, y = 2 * np.pi * x / columns, 2 * np.pi * y / rows
    height = 3 * np.sin(x) + 2 * np.cos(x + 2 * y)
    right = (3 * np.cos(x) - 2 * np.sin(x + 2 * y)) * 2 * np.pi / columns
    down = -4 * np.sin(x + 2 * y) * 2 * np.pi / rows
    return normalize(np.stack([-right, down, np.ones_like(x)], -1)), height.astype(np.float32)


@pytest.mark.parametrize("size", [(60, 90), (151, 203), (240, 260)])
def test_heights_of_what_repeats_repeat(size: tuple[int, int]) -> None:
    normals, true = rolling(*size)
    everywhere = np.ones(size, np.bool_)
    found = integrate(normals, everywhere, tile="both")
    assert np.abs(found - true).max() < 0.15
    for axis in (0, 1):
        other = integrate(np.roll(normals, 21, axis), everywhere, tile="both")
        assert np.abs(np.roll(found, 21, axis) - other).max() < 0.15


def test_a_part_that_lies_across_an_edge_is_one() -> None:
    normals, true = rolling(64, 64)
    y, x = np.indices(true.shape) + 0.5
    mask = np.hypot(np.minimum(x, 64 - x), y - 32) < 20
    mask |= np.hypot(x - 32, np.minimum(y, 64 - y)) < 10
    found = integrate(normals, mask, tile="both")
    ring, cap = mask & ((x < 21) | (x > 43)), mask & (x > 21) & (x < 43)
    for part in (ring, cap):
        assert np.abs(found - (true - true[part].mean()))[part].max() < 0.1
    assert np.abs(integrate(normals, mask, tile="x") - found)[ring].max() < 0.01
    # Halves that know nothing of each other have means of their own.
    assert np.abs(integrate(normals, mask) - found)[ring].max() > 0.5
