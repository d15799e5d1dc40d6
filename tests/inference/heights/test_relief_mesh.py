from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.errors import InputError
from normalgan.inference.heights.relief_mesh import encode_relief, relief_mesh


def dome(size: int = 40) -> tuple[NDArray[np.float32], BoolMask]:
    """A hemisphere that fills most of the frame, in pixels, with a hole off its middle."""
    along = np.arange(size) + 0.5 - size / 2
    x, y = np.meshgrid(along, -along)
    radius = 0.45 * size
    mask = np.hypot(x, y) < radius
    height = np.sqrt(np.maximum(radius**2 - x**2 - y**2, 0))
    return height.astype(np.float32), mask & (np.hypot(x - 8, y - 5) > 3)


def random_mask(seed: int) -> BoolMask:
    """Pixels that touch in every way that they can: at edges, at corners alone, and not at all."""
    return np.random.default_rng(seed).random((12, 9)) < 0.55


@pytest.mark.parametrize("seed", range(6))
def test_every_mask_gives_a_closed_solid(seed: int) -> None:
    mask = random_mask(seed)
    height = np.random.default_rng(seed).normal(size=mask.shape).astype(np.float32)
    solid = relief_mesh(height, mask)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume > 0


def test_the_front_lies_where_the_picture_shows_it() -> None:
    mask = np.zeros((20, 40), dtype=bool)
    mask[2:6, 30:38] = True  # above, to the right
    mesh = relief_mesh(np.zeros(mask.shape, np.float32), mask)
    low, high = mesh.bounds
    assert high[:2] == pytest.approx([38 / 40 - 0.5, (10 - 2) / 40], abs=0.03)
    assert low[:2] == pytest.approx([30 / 40 - 0.5, (10 - 6) / 40], abs=0.03)
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(0.03)


def front_of(height: NDArray[np.float32], mask: BoolMask) -> NDArray[np.float64]:
    """Return the vertices of a relief's front in pixels of a picture of 40, their heights as given."""
    vertices = np.asarray(relief_mesh(height, mask).vertices)
    return vertices[: len(vertices) // 2] * [40, 40, 80]  # a relief has half of the depth


def test_a_dome_keeps_its_shape_and_its_hole() -> None:
    height, mask = dome()
    front = front_of(height, mask)
    inner = np.hypot(*front[:, :2].T) < 14
    assert np.linalg.norm(front[inner], axis=1) == pytest.approx(18, abs=0.5)
    assert relief_mesh(height, mask).euler_number == 0  # a solid with one hole through it


def test_the_rim_is_smoother_than_a_staircase() -> None:
    height, mask = dome()
    front, faces = front_of(0 * height, mask), relief_mesh(0 * height, mask).faces
    sides = faces[(faces < len(front)).any(1) & (faces >= len(front)).any(1)]
    outer = np.hypot(*front[np.unique(sides[sides < len(front)])][:, :2].T)
    outer = outer[outer > 14]
    assert np.abs(outer - 18).max() < 0.6  # corners of pixels reach √½ out and as far in


@pytest.mark.parametrize("form", ["glb", "obj"])
def test_the_same_relief_gives_the_same_bytes(form: Literal["glb", "obj"]) -> None:
    first, second = (encode_relief(relief_mesh(*dome()), form) for _ in range(2))
    assert first == second


def test_what_makes_no_relief_is_refused() -> None:
    height, mask = dome()
    with pytest.raises(InputError, match="the mask is empty"):
        relief_mesh(height, mask & False)
    with pytest.raises(InputError, match=r"heights of \(39, 40\) do not match a mask of \(40, 40\)"):
        relief_mesh(height[1:], mask)
