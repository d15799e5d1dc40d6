"""Checks of a line style."""

import copy
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.animals import Animal
from normalgan.inference.regions import around
from normalgan.rendering.lines import LineDrawing
from normalgan.rendering.lines.base import check_strokes
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.strokes import Stroke, rasterise
from normalgan.rendering.view import View
from normalgan.testing.conformance import Check, demand, held_to_contract, promised, seed_checks
from normalgan.testing.settings import frozen_check, settings_checks
from normalgan.testing.solids import away, camera

_STROKES = promised(LineDrawing.trace)
_SIZE = 96
_SLACK = 2.0  # pixels that a line may extend beyond the frame, where it is clipped


def line_drawing_checks() -> list[Check[LineDrawing]]:
    """Return the named checks of a line style, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(LineDrawing),  # type: ignore[type-abstract]
        frozen_check(),
        Check("strokes", _strokes, _STROKES),
        Check("strokes inside the picture", _within, _STROKES),
        Check("visible pens", _pens, _STROKES),
        Check("ink on the object", _ink, _STROKES),
        Check("views of other sizes and cameras", _views, "all sizes and cameras must work"),
        Check("an empty view", _empty, "an empty view must give no strokes"),
        *seed_checks(_parts, "rng"),
        Check("an unchanged view", _untouched, "all styles share the maps of the view"),
    ]


@cache
def _animal() -> Mesh:
    return Animal("horse", 1).load()


def _view(size: int = _SIZE, field_of_view: float | None = None) -> View:
    mesh = _animal()
    return View(mesh, camera(mesh, field_of_view), EmbreeRenderer(), size)


def _trace(style: LineDrawing, view: View, seed: int = 0) -> Sequence[Stroke]:
    with held_to_contract():
        return check_strokes(style, style.trace(view, np.random.default_rng(seed)), view.size)


def _strokes(style: LineDrawing) -> None:
    _trace(style, _view())


def _within(style: LineDrawing) -> None:
    for stroke in _trace(style, _view()):
        reach = _SLACK + float(stroke.width.max())
        low, high = float(stroke.points.min()), float(stroke.points.max())
        did = f"traced a stroke from {low:.0f} to {high:.0f} pixels in a sketch of {_SIZE}"
        asked = "points are in pixels, from 0 to view.size, with x to the right and y down"
        demand(-reach <= low and high <= _SIZE + reach, style, did, asked)


def _pens(style: LineDrawing) -> None:
    for stroke in _trace(style, _view()):
        demand(
            stroke.width.min() > 0, style, "traced a stroke of width 0 or less", "a pen must be wider than 0"
        )
        good = bool(((stroke.darkness >= 0) & (stroke.darkness <= 1)).all())
        did = f"traced a stroke of darkness {stroke.darkness.min():.2g} to {stroke.darkness.max():.2g}"
        demand(good, style, did, "darkness must be between 0 (paper) and 1")


def _ink(style: LineDrawing) -> None:
    view = _view()
    ink = rasterise(_trace(style, view), _SIZE)
    demand(ink.max() > 0.1, style, "drew nothing of an animal", "each object must give some ink")
    # Nearly all lines must be within the object's mask, dilated by a few pixels.
    share = float(ink[around(view.maps().mask, 4)].sum() / ink.sum())
    asked = "lines must lie on the object; y grows downwards in strokes"
    demand(share > 0.95, style, f"put {1 - share:.0%} of its ink outside the animal", asked)


def _views(style: LineDrawing) -> None:
    for size, field_of_view in ((32, None), (49, 40.0)):
        _trace(style, _view(size, field_of_view))


def _empty(style: LineDrawing) -> None:
    mesh = _animal()
    strokes = _trace(style, View(mesh, away(mesh), EmbreeRenderer(), _SIZE))
    ink = float(rasterise(strokes, _SIZE).sum())
    demand(ink == 0, style, "drew something in an empty view", "it must draw nothing there")


def _parts(style: LineDrawing, seed: int) -> list[NDArray[Any]]:
    strokes = _trace(style, _view(), seed)
    return [part for stroke in strokes for part in (stroke.points, stroke.width, stroke.darkness)]


def _untouched(style: LineDrawing) -> None:
    view = _view()
    kept = {scale: copy.deepcopy(view.maps(scale)) for scale in (1, 2)}
    _trace(style, view)
    for scale, before in kept.items():
        same = all(
            np.array_equal(getattr(view.maps(scale), name), getattr(before, name))
            for name in ("normal", "depth", "mask")
        )
        demand(same, style, "changed the maps of the view", "all styles share them, so copy them")
