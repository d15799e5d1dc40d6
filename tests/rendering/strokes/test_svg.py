from xml.etree import ElementTree as ET

import cv2
import numpy as np
import pytest

from normalgan.rendering.strokes import Stroke
from normalgan.rendering.strokes.svg import outline, to_svg

SVG = "{http://www.w3.org/2000/svg}"
ARC = np.linspace(0, np.pi, 60)
ROUND = np.linspace(0, 2 * np.pi, 120)


def tapered() -> Stroke:
    """A half circle of radius 20 about (32, 40), thin at both ends."""
    points = np.stack([32 + 20 * np.cos(ARC), 40 - 20 * np.sin(ARC)], axis=1)
    return Stroke(points, 1 + 4 * np.sin(ARC), np.full(60, 0.5))


def ring() -> Stroke:
    points = np.stack([32 + 20 * np.cos(ROUND), 32 + 20 * np.sin(ROUND)], axis=1)
    points[-1] = points[0]
    return Stroke(points, 3 + np.cos(ROUND), np.ones(120))


def filled(stroke: Stroke) -> float:
    """Return the area of the nonzero fill in pixels, by painting it 16 times larger."""
    picture = np.zeros((1024, 1024), np.uint8)
    rings = outline(stroke)
    cv2.fillPoly(picture, [np.rint(16 * ring).astype(np.int32) for ring in rings], 1)
    return float(picture.sum()) / 256


def test_a_tapered_stroke_has_its_width_along_its_whole_length() -> None:
    stroke = tapered()
    expected = 20 * np.trapezoid(stroke.width, ARC) + np.pi * 0.5**2
    assert filled(stroke) == pytest.approx(expected, rel=0.02)


def test_a_closed_stroke_is_empty_inside() -> None:
    stroke = ring()
    assert stroke.closed
    assert len(outline(stroke)) == 2
    assert filled(stroke) == pytest.approx(2 * np.pi * 20 * 3, rel=0.03)


def test_ends_are_round() -> None:
    bar = Stroke(np.array([[10.0, 10.0], [20.0, 10.0]]), np.array([4.0, 4.001]), np.ones(2))
    x, y = outline(bar)[0].T
    assert (x.min(), x.max()) == pytest.approx((8, 22), abs=0.1)
    assert (y.min(), y.max()) == pytest.approx((8, 12), abs=0.01)


def test_a_pen_that_turns_back_makes_no_nan() -> None:
    back = Stroke(np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 0.0], [0.0, 0.0]]), np.arange(1.0, 5.0), np.ones(4))
    assert all(np.isfinite(one).all() for one in outline(back))


def test_the_document_has_a_path_a_stroke_in_their_order() -> None:
    even = Stroke.even(np.array([[1.0, 1.0], [3.0, 4.0], [6.0, 4.0]]), width=1.25, darkness=0.8)
    root = ET.fromstring(to_svg([even, tapered(), ring()], 64))
    assert root.get("viewBox") == "0 0 64 64"
    paths = list(root.iter(f"{SVG}path"))
    assert [path.get("fill") for path in paths] == [None, "#000", "#000"]
    assert paths[0].get("stroke-width") == "1.25"
    assert [path.get("opacity") for path in paths] == ["0.8", "0.5", None]
    assert paths[0].get("d") == "M1 1L3 4L6 4"


def test_a_drawing_without_strokes_is_blank_paper() -> None:
    assert not list(ET.fromstring(to_svg([], 16)).iter(f"{SVG}path"))


def test_an_even_closed_stroke_is_a_closed_path() -> None:
    square = np.array([[1.0, 1.0], [5.0, 1.0], [5.0, 5.0], [1.0, 1.0]])
    assert 'd="M1 1L5 1L5 5Z"' in to_svg([Stroke.even(square, 1)], 8)
