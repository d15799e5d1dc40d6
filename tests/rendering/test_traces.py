"""What the strokes of every style keep, before they are pixels."""

import numpy as np
import pytest
from mesh_shapes import as_mesh, camera_at, trimesh
from scenes import EYE, bumps, sphere, view

from normalgan.rendering.lines import LineDrawing, OccludingContours, SuggestiveContours
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.strokes import Stroke, resample
from normalgan.rendering.view import View

both_styles = pytest.mark.parametrize(
    "style", [OccludingContours(), SuggestiveContours()], ids=lambda s: type(s).__name__
)


def trace(style: LineDrawing, seen: View) -> list[Stroke]:
    return style.trace(seen, np.random.default_rng(0))


def area(points: np.ndarray) -> float:
    """Return the area within a closed polygon."""
    (x, y), (x1, y1) = points[:-1].T, points[1:].T
    return float(abs((x * y1 - x1 * y).sum()) / 2)


@both_styles
@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("size", [64, 256, 512])
def test_the_outline_of_a_sphere_is_its_circle(style: LineDrawing, size: int, perspective: bool) -> None:
    (outline,) = trace(style, view(sphere(0.1, -0.05, 0, 0.6), size=size, perspective=perspective))
    assert outline.closed
    assert set(outline.width) == {1.25}
    assert set(outline.darkness) == {1.0}
    if perspective:  # the outline is an ellipse about another centre: measure one about the axis instead
        (outline,) = trace(style, view(sphere(0, 0, 0, 0.6), size=size, perspective=True))
    centre = np.array([0.0, 0.0]) if perspective else np.array([0.1, 0.05])
    radius = (EYE * np.tan(np.arcsin(0.6 / EYE)) if perspective else 0.6) * size / 2
    assert np.sqrt(area(outline.points) / np.pi) == pytest.approx(radius, abs=0.1)
    off = np.hypot(*(outline.points - (1 + centre) * size / 2).T) - radius
    assert np.sqrt((off**2).mean()) < 0.1 * max(size / 256, 1)  # of pixels of maps 512 a side, where larger


def torus() -> View:
    ring = trimesh.creation.torus(0.7, 0.3, 96, 48)
    mesh = as_mesh("torus", ring.vertices, ring.faces)
    return View(mesh, camera_at(mesh, 0, 35, 0), EmbreeRenderer(), 128)


@both_styles
def test_a_torus_has_an_inner_contour(style: LineDrawing) -> None:
    outer, inner = trace(style, torus())[:2]
    assert outer.closed
    low, high = outer.points.min(axis=0), outer.points.max(axis=0)
    assert (inner.points > low + 5).all()
    assert (inner.points < high - 5).all()
    assert inner.length > 30


@both_styles
def test_a_hidden_outline_ends_on_the_one_that_hides_it(style: LineDrawing) -> None:
    near, far = trace(style, view(sphere(-0.2, 0, 0.5, 0.4), sphere(0.3, 0, -0.4, 0.4)))
    assert near.closed
    assert not far.closed
    for end in (far.points[0], far.points[-1]):
        assert np.hypot(*(resample(near.points, 0.1) - end).T).min() < 0.3
    assert far.length == pytest.approx(0.4 * 64 * 2 * (np.pi - np.arccos(0.25 / 0.4)), rel=0.02)


@both_styles
def test_a_drawing_twice_as_large_is_the_same_drawing(style: LineDrawing) -> None:
    small, large = (trace(style, view(bumps(0.03), size=size)) for size in (128, 256))
    assert len(small) == len(large)
    for one, other in zip(small, large, strict=True):
        assert other.length == pytest.approx(2 * one.length, rel=0.02)
        nearest = np.hypot(*(other.points[:, None] / 2 - one.points).transpose(2, 0, 1)).min(axis=1)
        assert nearest.max() < 0.6  # points lie a pixel apart
        np.testing.assert_array_equal(np.unique(one.width), np.unique(other.width))


def test_contours_come_first_and_strokes_inside_are_thinner() -> None:
    widths = [
        stroke.width.max() for stroke in trace(SuggestiveContours(interior_width=0.5), view(bumps(0.03)))
    ]
    assert widths == sorted(widths, reverse=True)
    assert set(widths) == {1.25, 0.5}
    outline = trace(SuggestiveContours(interior_width=0.0), view(bumps(0.03)))
    assert {stroke.width.max() for stroke in outline} == {1.25}
