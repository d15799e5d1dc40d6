from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import BoolMask
from normalgan.errors import InputError
from normalgan.inference.heights.relief import check_relief_path, relief_mesh, write_relief


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
    assert relief_mesh(height, mask, backing="plate").is_watertight


def test_the_front_lies_where_the_picture_shows_it() -> None:
    mask = np.zeros((20, 40), dtype=bool)
    mask[2:6, 30:38] = True  # above, to the right
    mesh = relief_mesh(np.zeros(mask.shape, np.float32), mask, backing="open")
    low, high = mesh.bounds
    assert high[:2] == pytest.approx([38 / 40 - 0.5, (10 - 2) / 40], abs=0.03)
    assert low[:2] == pytest.approx([30 / 40 - 0.5, (10 - 6) / 40], abs=0.03)
    assert (mesh.face_normals[:, 2] > 0.99).all()


def test_a_dome_keeps_its_shape_and_its_hole() -> None:
    height, mask = dome()
    mesh = relief_mesh(height, mask, backing="open", depth=1.0)
    radius = np.linalg.norm(mesh.vertices * 40, axis=1)
    inner = np.hypot(*mesh.vertices[:, :2].T) * 40 < 14
    assert radius[inner] == pytest.approx(18, abs=0.5)
    assert not mesh.is_watertight
    assert relief_mesh(height, mask).euler_number == 0  # a solid with one hole through it
    flatter = relief_mesh(height, mask, backing="open", depth=0.25)
    assert np.ptp(flatter.vertices[:, 2]) == pytest.approx(np.ptp(mesh.vertices[:, 2]) / 4)


def test_the_rim_is_smoother_than_a_staircase() -> None:
    height, mask = dome()
    mesh = relief_mesh(0 * height, mask, backing="open")
    rim = np.asarray(mesh.edges_unique)[np.bincount(mesh.edges_unique_inverse) == 1]
    corners = mesh.vertices[np.unique(rim)][:, :2] * 40
    outer = np.hypot(*corners.T)
    outer = outer[outer > 14]
    assert np.abs(outer - 18).max() < 0.6  # corners of pixels reach √½ out and as far in


@pytest.mark.parametrize("suffix", [".glb", ".obj"])
def test_a_file_brings_back_the_solid_and_its_picture(tmp_path: Path, suffix: str) -> None:
    height, mask = dome()
    texture = np.zeros((80, 80, 3), np.uint8)
    texture[:40, :, 0], texture[40:, :, 2] = 255, 255  # red above, blue below
    path = tmp_path / "new" / f"a dome{suffix}"
    write_relief(path, relief_mesh(height, mask, texture))
    loaded: Any = trimesh.load(path, force="mesh")
    assert loaded.is_watertight
    assert loaded.volume == pytest.approx(relief_mesh(height, mask).volume, rel=1e-3)
    colours = loaded.visual.to_color().vertex_colors
    above = colours[loaded.vertices[:, 1] > 0.05].mean(axis=0)
    below = colours[loaded.vertices[:, 1] < -0.05].mean(axis=0)
    assert above[0] - above[2] > 245
    assert below[2] - below[0] > 245


def test_reliefs_in_one_folder_do_not_share_a_picture(tmp_path: Path) -> None:
    height, mask = dome()
    for name, level in (("a", 10), ("b", 200)):
        write_relief(tmp_path / f"{name}.obj", relief_mesh(height, mask, np.full((4, 4, 3), level, np.uint8)))
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        [f"{n}{end}" for n in "ab" for end in (".obj", ".mtl", "_material_0.png")]
    )
    for name, level in (("a", 10), ("b", 200)):
        assert np.asarray(Image.open(tmp_path / f"{name}_material_0.png")).max() == level
        assert f"{name}_material_0.png" in (tmp_path / f"{name}.mtl").read_text()


@pytest.mark.parametrize("suffix", [".glb", ".obj"])
def test_the_same_relief_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    height, mask = dome()
    paths = [tmp_path / name / f"dome{suffix}" for name in "ab"]
    for path in paths:
        write_relief(path, relief_mesh(height, mask))
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_what_makes_no_relief_is_refused() -> None:
    height, mask = dome()
    with pytest.raises(InputError, match="the mask is empty"):
        relief_mesh(height, mask & False)
    with pytest.raises(InputError, match=r"heights of \(39, 40\) do not go with a mask of \(40, 40\)"):
        relief_mesh(height[1:], mask)
    with pytest.raises(InputError, match="greater than 0, not 0 and"):
        relief_mesh(height, mask, depth=0)
    with pytest.raises(InputError, match=r"x\.stl is to be a \.glb or an \.obj"):
        check_relief_path("x.stl")
