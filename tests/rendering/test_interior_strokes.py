from dataclasses import replace

import numpy as np
import pytest
from grids import from_above, height_field, to_plane
from mesh_shapes import as_mesh, ellipsoid

from normalgan.arrays import Doubles
from normalgan.rendering.cameras import framed, look_at_origin, towards_eye
from normalgan.rendering.lines import LineDrawing, ObjectSpaceSuggestive, OccludingContours, RidgesAndValleys
from normalgan.rendering.lines.object_space import radial_curvature
from normalgan.rendering.lines.ridges import apparent_curvature, extremes
from normalgan.rendering.lines.surface import MeshSurface, shape_of
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View

STYLES = [ObjectSpaceSuggestive(theta=0), RidgesAndValleys()]
both_styles = pytest.mark.parametrize("style", STYLES, ids=lambda s: type(s).__name__)


def strokes_inside(style: LineDrawing, view: View) -> list[Stroke]:
    """Return the strokes that the style adds to the contours."""
    rng = np.random.default_rng(0)
    contours = len(OccludingContours().trace(view, rng))
    return style.trace(view, rng)[contours:]


def waves(x: Doubles, y: Doubles) -> Doubles:
    """Rings whose n·v along a radius is least halfway between crest and trough."""
    heights: Doubles = 0.06 * np.cos(14 * np.hypot(x, y))
    return heights


def roof(x: Doubles, y: Doubles) -> Doubles:
    heights: Doubles = -np.sqrt(x * x + 0.05**2)
    return heights


def test_suggestive_contours_of_waves_lie_where_the_slope_is_steepest() -> None:
    strokes = strokes_inside(ObjectSpaceSuggestive(theta=0, smoothing=0), from_above(height_field(waves)))
    # The slope 0.84 sin(14 r) is steepest there, and uphill, towards the eye, hollow turns to bulge.
    steepest = (np.arange(4) + 0.5) * np.pi / 14
    unit = 2 * 0.7 / 0.88 / 128  # of the field in a pixel
    drawn = np.zeros(4)
    for stroke in strokes:
        r = np.hypot(*to_plane(stroke.points).T)
        ring = np.abs(steepest - r.mean()).argmin()
        np.testing.assert_allclose(r, steepest[ring], atol=0.015)
        drawn[ring] += stroke.length * unit
    # The last one is cut off by the square.
    np.testing.assert_allclose(drawn[:3], 2 * np.pi * steepest[:3], rtol=0.03)


@pytest.mark.parametrize("sign", [1, -1], ids=["ridge", "valley"])
def test_the_fold_of_a_roof_is_drawn_once_from_end_to_end(sign: int) -> None:
    view = from_above(height_field(lambda x, y: sign * roof(x, y) + 0 * y))
    (stroke,) = strokes_inside(RidgesAndValleys(), view)
    x, y = to_plane(stroke.points).T
    assert np.abs(x).max() < 0.01
    assert np.ptp(y) > 1.2


@both_styles
def test_round_bodies_have_no_strokes_inside(style: LineDrawing) -> None:
    ball = ellipsoid(1, 1, 1, subdivisions=4)
    for field_of_view in (None, 40.0):
        camera = framed(ball.vertices, look_at_origin(30, 20, 0), field_of_view, 0.06)
        assert strokes_inside(style, View(ball, camera, EmbreeRenderer(), 128)) == []


@both_styles
def test_strokes_behind_something_are_not_drawn(style: LineDrawing) -> None:
    field = height_field(roof if isinstance(style, RidgesAndValleys) else waves)
    assert strokes_inside(style, from_above(field))
    # A sheet before the right half.
    sheet = np.array([[0.1, -0.7, 0.5], [0.7, -0.7, 0.5], [0.7, 0.7, 0.5], [0.1, 0.7, 0.5]])
    if isinstance(style, RidgesAndValleys):
        sheet -= [0.3, 0, 0]
    count = len(field.vertices)
    faces = np.array([[0, 1, 2], [0, 2, 3]]) + count
    behind = as_mesh("behind", np.concatenate([field.vertices, sheet]), np.concatenate([field.faces, faces]))
    for stroke in strokes_inside(style, from_above(behind)):
        x, _ = to_plane(stroke.points).T
        assert ((x < sheet[0, 0] + 0.02) | (x > sheet[1, 0] - 0.02)).all()


@both_styles
def test_strokes_keep_to_their_width_and_thin_out(style: LineDrawing) -> None:
    view = from_above(height_field(lambda x, y: waves(x, y) + 0.3 * roof(x, y)))
    for stroke in strokes_inside(style, view):
        assert stroke.width.max() <= 0.9 + 1e-9
        assert stroke.width.min() >= 0.3


def test_radial_curvature_is_that_of_the_section_through_the_eye() -> None:
    # A cylinder along y seen from above: the section towards the eye is the circle itself.
    shape = shape_of(height_field(lambda x, y: np.sqrt(1 - x * x) + 0 * y, half=0.6), 0.0)
    x, y, _ = shape.surface.vertices.T
    eye = np.broadcast_to([0.0, 0.0, 1.0], shape.surface.vertices.shape)
    facing, radial, _ = radial_curvature(shape, eye)
    inner = (np.abs(x) < 0.5) & (np.abs(y) < 0.5)
    np.testing.assert_allclose(facing[inner], np.sqrt(1 - x * x)[inner], atol=2e-3)
    np.testing.assert_allclose(radial[inner], (x * x)[inner], atol=0.01)  # 1 / R times sin²


def test_apparent_curvature_of_a_cylinder_is_foreshortened_along_its_round_side() -> None:
    shape = shape_of(height_field(lambda x, y: np.sqrt(1 - x * x) + 0 * y, half=0.6), 0.0)
    x, y, _ = shape.surface.vertices.T
    eye = np.broadcast_to([0.0, 0.0, 1.0], shape.surface.vertices.shape)
    curvature, along = apparent_curvature(shape, eye)
    inner = (np.abs(x) < 0.5) & (np.abs(y) < 0.5)
    # In the picture the normal's angle is asin x: it turns by 1 / cos of it per unit.
    np.testing.assert_allclose(curvature[inner], 1 / np.sqrt(1 - x * x)[inner], rtol=0.02)
    np.testing.assert_allclose(np.abs(along[inner, 0]), 1, atol=0.02)  # one unit of the picture
    assert np.abs(along[inner, 1]).max() < 0.05


def test_extremes_are_found_whatever_the_sign_of_the_directions() -> None:
    surface = MeshSurface.of(height_field(lambda x, y: 0 * x * y, points=60))
    x = surface.vertices[:, 0]
    signs = np.where(np.random.default_rng(3).random(len(x)) < 0.5, -1.0, 1.0)
    along = np.stack([signs, 0 * x, 0 * x], axis=1)
    marks, peaked = extremes(surface, np.exp(-((x - 0.05) ** 2)), along)
    at = marks.take(surface, surface.vertices)
    middle = np.abs(at[:, 1]) < 0.6  # at the border of a sheet slopes are one-sided
    np.testing.assert_allclose(at[middle, 0], 0.05, atol=5e-3)
    np.testing.assert_allclose(peaked[middle], 2, rtol=0.15)  # a second derivative on random triangles
    assert np.ptp(at[:, 1]) > 1.3


def test_towards_eye_points_at_the_eye() -> None:
    mesh = ellipsoid(1, 0.7, 0.5, subdivisions=3)
    camera = framed(mesh.vertices, look_at_origin(40, 20, 5), 30.0, 0.06)
    eye = -camera.rotation.T @ camera.translation
    points = mesh.vertices.astype(np.float64)
    across = np.cross(towards_eye(camera, points), eye - points)
    np.testing.assert_allclose(across, 0, atol=1e-9)


@both_styles
def test_torn_meshes_with_loose_points_are_drawn(style: LineDrawing) -> None:
    field = height_field(roof if isinstance(style, RidgesAndValleys) else waves, points=48)
    holes = np.random.default_rng(0).random(len(field.faces)) < 0.9
    torn = replace(field, faces=field.faces[holes])
    loose = replace(torn, vertices=np.append(torn.vertices, np.array([[0, 0, 0.9]], np.float32), axis=0))
    loose = replace(loose, normals=np.append(torn.normals, np.array([[0, 0, 1]], np.float32), axis=0))
    view = from_above(loose)
    assert len(style.trace(view, np.random.default_rng(0))) > 0
    assert all(np.isfinite(stroke.points).all() for stroke in strokes_inside(style, view))


@both_styles
def test_a_single_triangle_has_its_outline_alone(style: LineDrawing) -> None:
    corners = np.array([[-0.6, -0.5, 0.0], [0.6, -0.5, 0.0], [0.0, 0.6, 0.0]])
    view = from_above(as_mesh("triangle", corners, np.array([[0, 1, 2]])))
    assert strokes_inside(style, view) == []
    assert len(style.trace(view, np.random.default_rng(0))) == 1
