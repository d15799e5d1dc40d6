"""The layout of OpenSketch (Gryaditskaya et al., ACM Transactions on Graphics 38(6), 2019).

Published: ``…/DESIGNER/OBJECT/view1_concept.json``, ``view1_presentation.json`` and the same of view 2, with
``canvas`` (``width``, ``height``, ``pen_width``) and ``strokes`` (``is_removed``, ``points`` of ``x``, ``y``
and pressure ``p``); width of a stroke is the pen's times the pressure, opacity the pressure. Seen in programs
of others: ``OBJECT.obj``, and ``DESIGNER_OBJECT_v1_points.json`` with ``points_2D_sketch`` in pixels of the
canvas and ``points_3D_object``. The camera is fitted to these points anew, as conventions of the published
camera files are nowhere described.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from normalgan.benchmark.human.drawing import Found, HumanDrawing, read_json, stroke_of
from normalgan.benchmark.human.registration import fit_projection
from normalgan.errors import InputError, brief
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["is_opensketch", "read_opensketch"]

_SKETCH = re.compile(r"view([12])_(concept|presentation)\.json", re.IGNORECASE)
_OFF = 0.1
"""A camera that misses its points by more of the sheet's width in the mean was not fitted to this drawing."""


def is_opensketch(folder: Path) -> bool:
    """Return whether a folder is laid out like this."""
    return any(_SKETCH.fullmatch(path.name) for path in folder.rglob("*.json"))


def read_opensketch(folder: Path) -> Found:
    """Return the drawings in a folder."""
    sketches = sorted(path for path in folder.rglob("*.json") if _SKETCH.fullmatch(path.name))
    meshes = {path.stem.lower(): path for path in sorted(folder.rglob("*.obj"))}
    points = {path.name.lower(): path for path in sorted(folder.rglob("*_points.json"))}
    drawings, left_out = [], []
    for path in sketches:
        try:
            drawings.append(_read(path, meshes, points))
        except InputError as error:
            left_out.append(str(error))
    return Found("OpenSketch", drawings, left_out)


def _read(path: Path, meshes: dict[str, Path], points: dict[str, Path]) -> HumanDrawing:
    match = _SKETCH.fullmatch(path.name)
    assert match is not None
    view, kind = match[1], match[2].lower()
    designer, thing = path.absolute().parts[-3:-1]
    wanted = f"{designer}_{thing}_v{view}_points.json".lower()
    if thing.lower() not in meshes:
        raise InputError(f"{path} is left out: there is no {thing}.obj anywhere in the folder.")
    if wanted not in points:
        raise InputError(
            f"{path} is left out: there is no {wanted} anywhere in the folder, which registers it."
        )
    content = read_json(path)
    try:
        canvas, strokes = content["canvas"], content["strokes"]
        side = round(max(float(canvas["width"]), float(canvas["height"])))
        pen = float(canvas["pen_width"])
        drawn = [stroke for one in strokes if (stroke := _stroke(one, pen, path))]
        pairs = read_json(points[wanted])
        projection, misses = fit_projection(
            np.array(pairs["points_3D_object"], np.float64).reshape(-1, 3),
            np.array(pairs["points_2D_sketch"], np.float64).reshape(-1, 2),
        )
    except InputError as error:  # before ValueError, which it is too
        raise InputError(f"{path} is left out: {error}") from error
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"{path} is left out: it or its points are not laid out like OpenSketch ({brief(error)})."
        ) from error
    if misses > _OFF * side:
        raise InputError(
            f"{path} is left out: the camera fitted to its points misses them by {misses:.0f} of {side} "
            "pixels."
        )
    name = f"{thing}/{designer}_view{view}_{kind}"
    return HumanDrawing(name, kind, drawn, side, meshes[thing.lower()], projection, misses)


def _stroke(one: dict[str, Any], pen: float, path: Path) -> Stroke | None:
    if one.get("is_removed"):
        return None
    places = [(point["x"], point["y"]) for point in one["points"]]
    stroke = stroke_of(places, pen, 1.0, str(path))
    if stroke is None:
        return None
    # The data's mean pressure a stroke, as in its own SVG files: repeated points were dropped above.
    pressure = float(np.clip(np.mean([point["p"] for point in one["points"]]), 0.0, 1.0))
    return Stroke.even(stroke.points, max(pen * pressure, 0.1) if pen > 0 else pen, pressure)
