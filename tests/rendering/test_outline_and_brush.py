from dataclasses import replace

import numpy as np
import pytest
from mesh_shapes import as_mesh, ellipsoid
from scenes import ink, plane, sphere, view

from normalgan.arrays import BoolMask, Doubles
from normalgan.errors import InputError
from normalgan.rendering.cameras import Views, framed, look_at_origin
from normalgan.rendering.lines import LINE_DRAWINGS, Brush, LineDrawing, Mixture, Silhouette
from normalgan.rendering.lines.brush import thin
from normalgan.rendering.lines.contours import borders
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.samples import Recipe
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View

RNG = np.random.default_rng(0)


def distances(stroke: Stroke, size: int = 128) -> Doubles:
    """Return how far the points are from the middle of the sketch, in pixels."""
    away: Doubles = np.hypot(*(stroke.points - size / 2).T)
    return away


def ring_mask(side: int, outer: float, inner: float) -> BoolMask:
    y, x = np.mgrid[:side, :side] + 0.5 - side / 2
    r = np.hypot(x, y)
    mask: BoolMask = (r < outer) & (r > inner)
    return mask


@pytest.mark.parametrize("perspective", [False, True])
def test_silhouette_of_a_sphere_is_one_closed_circle(perspective: bool) -> None:
    (stroke,) = Silhouette().trace(view(sphere(0, 0, 0, 0.6), perspective=perspective), RNG)
    radius = 64 * (3 * np.tan(np.arcsin(0.6 / 3)) if perspective else 0.6)
    assert stroke.closed
    np.testing.assert_allclose(distances(stroke), radius, atol=0.12)


def test_silhouette_leaves_out_what_lies_inside() -> None:
    (stroke,) = Silhouette().trace(view(sphere(0, 0, 0, 0.6), sphere(0.1, 0.1, 0.7, 0.2)), RNG)
    np.testing.assert_allclose(distances(stroke), 38.4, atol=0.12)


def test_silhouette_goes_round_holes_too() -> None:
    lines = borders(ring_mask(200, 80, 30)).lines(0, 10)
    radii = [np.hypot(*(line.points - 100).T) for line in lines]
    assert [round(float(r.mean())) for r in radii] == [80, 30]
    assert all((line.points[0] == line.points[-1]).all() for line in lines)


def test_silhouette_has_no_line_along_the_frame() -> None:
    mask = np.ones((20, 20), bool)
    mask[:, 12:] = False
    (line,) = borders(mask).lines(0, 3)
    np.testing.assert_array_equal(line.points[:, 0], 12)
    assert np.ptp(line.points[:, 1]) == 19


def test_brush_goes_once_round_a_sphere_just_inside_its_outline() -> None:
    (stroke,) = Brush().trace(view(sphere(0, 0, 0, 0.6)), RNG)
    assert stroke.closed
    r = distances(stroke)
    assert r.max() < 38.6
    assert r.min() > 38.4 - 3
    assert np.ptp(r) < 0.5
    np.testing.assert_allclose(stroke.width, 2, rtol=0.1)


def test_brush_is_thick_where_the_surface_turns_away_slowly() -> None:
    body = ellipsoid(1, 0.3, 0.3, subdivisions=5)
    camera = framed(body.vertices, look_at_origin(0, 0, 0), None, 0.06)
    (stroke,) = Brush().trace(View(body, camera, EmbreeRenderer(), 256), RNG)
    x, y = (stroke.points - 128).T
    sides, ends = stroke.width[np.abs(x) < 20].mean(), stroke.width[np.abs(y) < 5].mean()
    # The sections are of radius 0.3 at the sides and 0.09 at the ends.
    assert sides > 1.1 * ends
    assert stroke.width.max() <= 4


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.6, 0.3, 0.7), (1.0, 0.0, 0.12)])
def test_brush_makes_no_blots_on_flat_faces_however_steep(normal: tuple[float, float, float]) -> None:
    sketch = ink(Brush(), view(plane(normal, 0.6)))
    edge = int(64 * 0.4) + 6
    assert sketch.max() > 0.5
    assert sketch[edge:-edge, edge:-edge].max() == 0


@pytest.mark.parametrize("size", [64, 128, 256])
def test_brush_is_as_wide_in_pixels_at_every_size(size: int) -> None:
    strokes = Brush(line_width=3).trace(view(sphere(0, 0, 0, 0.6), size=size), RNG)
    widths = np.concatenate([stroke.width for stroke in strokes])
    assert np.median(widths) == pytest.approx(3, rel=0.1)


def test_thinning_keeps_rings_closed_and_crossings_straight() -> None:
    ((points, width),) = thin(ring_mask(100, 40, 33))
    assert (points[0] == points[-1]).all()
    assert np.hypot(*(points - 50).T).mean() == pytest.approx(36.5, abs=0.4)
    assert np.median(width) == pytest.approx(7, abs=1)
    cross = np.zeros((60, 60), bool)
    cross[28:31, 4:56] = cross[4:56, 28:31] = True
    spans = sorted(tuple(np.ptp(points, axis=0) > 40) for points, _ in thin(cross) if len(points) > 10)
    assert spans == [(False, True), (True, False)]


def test_an_empty_picture_and_a_single_pixel_have_no_lines() -> None:
    alone = np.zeros((5, 5), bool)
    assert thin(alone) == []
    alone[2, 2] = True
    assert thin(alone) == []


@pytest.mark.parametrize("kind", list(LINE_DRAWINGS), ids=lambda kind: kind.__name__)
def test_a_sheet_seen_edge_on_is_refused_by_name(kind: type[LineDrawing]) -> None:
    lines = Mixture([Silhouette()]) if kind is Mixture else kind()
    corners = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    sheet = as_mesh("sheet of paper", corners, np.array([[0, 1, 2], [0, 2, 3]]))
    edge_on = Views(azimuth=(30, 30), elevation=(0, 0), roll=(5, 5), perspective=0)
    with pytest.raises(InputError, match=f"{kind.__name__} finds no lines in sheet of paper, view 3: there"):
        Recipe(edge_on, EmbreeRenderer(), lines, size=32).render(sheet, 3)
    from_above = Recipe(replace(edge_on, elevation=(40, 40)), EmbreeRenderer(), lines, size=32)
    assert from_above.render(sheet, 3).sketch.max() > 100
