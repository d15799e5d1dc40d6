from dataclasses import replace

import numpy as np
import pytest
from scenes import bumps, cube, ink, look, plane, sphere, still, view

from normalgan.arrays import BoolMask, Floats
from normalgan.rendering.lines import LineDrawing, OccludingContours, SuggestiveContours
from normalgan.rendering.maps import Maps

WAVY = bumps(0.03)
STYLES = [OccludingContours(), SuggestiveContours()]
both_styles = pytest.mark.parametrize("style", STYLES, ids=lambda s: type(s).__name__)
both_cameras = pytest.mark.parametrize("perspective", [False, True], ids=["orthographic", "perspective"])


def inside_of_square(sketch: Floats, half: float) -> Floats:
    size = len(sketch)
    edge = int(np.ceil(size / 2 * (1 - half))) + 3
    return sketch[edge:-edge, edge:-edge]


def nothing(side: int = 512) -> tuple[Floats, Floats, BoolMask]:
    """Return the normal, depth and mask of an empty frame."""
    shape = (side, side)
    return np.zeros((*shape, 3), np.float32), np.full(shape, np.inf, np.float32), np.zeros(shape, bool)


@both_styles
@both_cameras
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.6, 0.3, 0.7), (1.0, 0.0, 0.12), (0.5, -1.0, 0.2)])
def test_planes_however_steep_have_no_ink_inside(
    style: LineDrawing, normal: tuple[float, float, float], perspective: bool
) -> None:
    half = 0.15 if perspective and normal[2] < 0.5 else 0.6  # a wider steep one would pass behind the eye
    sketch = ink(style, view(plane(normal, half), perspective=perspective))
    assert sketch.max() > 0.5
    assert inside_of_square(sketch, half).max() == 0


def test_coarse_meshes_whose_normals_deny_the_slope_have_no_ink_inside() -> None:
    maps = look(plane((1.0, 0.0, 0.05), 0.6))
    frontal = np.where(maps.mask[..., None], [0, 0, 1], 0).astype(np.float32)
    sketch = ink(OccludingContours(), still(replace(maps, normal=frontal)))
    assert inside_of_square(sketch, 0.6).max() == 0


def test_twice_the_width_is_twice_the_ink() -> None:
    maps = look(sphere(0, 0, 0, 0.6))
    once, twice = (ink(OccludingContours(line_width=width), still(maps)).sum() for width in (1.0, 2.0))
    assert twice / once == pytest.approx(2, rel=0.06)


@both_styles
@pytest.mark.parametrize("shift", [(5, 0), (-3, 7)])
def test_the_drawing_moves_with_the_object(style: LineDrawing, shift: tuple[int, int]) -> None:
    here = look(WAVY)
    fine = (4 * shift[1], 4 * shift[0])
    normal, depth = (np.roll(a, fine, (0, 1)) for a in (here.normal, here.depth))
    there = Maps(normal, depth, np.roll(here.mask, fine, (0, 1)))
    expected = np.roll(ink(style, still(here)), shift[::-1], (0, 1))
    np.testing.assert_array_equal(ink(style, still(there)), expected)


def test_creases_draw_the_near_edges_of_a_cube_once() -> None:
    maps = look(cube(0.45))
    plain, creased = ink(OccludingContours(), still(maps)), ink(OccludingContours(crease=40), still(maps))
    added = (creased - plain).sum()
    # Three edges meet at the near corner; the picture of each edge e is as long as its x and y.
    a, b = np.deg2rad(35), np.deg2rad(25)
    lengths = [
        np.hypot(np.cos(a), np.sin(b) * np.sin(a)),
        np.cos(b),
        np.hypot(np.sin(a), np.sin(b) * np.cos(a)),
    ]
    assert added == pytest.approx(1.25 * 0.9 * 64 * sum(lengths), rel=0.12)


@both_styles
def test_an_object_cut_by_the_frame_has_no_line_along_the_frame(style: LineDrawing) -> None:
    sketch = ink(style, view(plane((0.2, 0.1, 1.0), 5.0), size=64))
    assert sketch.max() == 0


@both_styles
def test_a_single_pixel_is_no_error(style: LineDrawing) -> None:
    normal, depth, mask = nothing()
    normal[0, 5, 2], depth[0, 5], mask[0, 5] = 1, 2, True
    assert ink(style, still(Maps(normal, depth, mask), 16)).max() == 0


@both_styles
def test_specks_are_left_out(style: LineDrawing) -> None:
    scene, speck = sphere(0.3, 0, 0, 0.4), sphere(-0.7, 0, 0, 0.004)
    np.testing.assert_array_equal(ink(style, view(scene, speck)), ink(style, view(scene)))
