"""The layout of Tracing versus Freehand (Wang et al., ACM Transactions on Graphics 40(4), 2021).

Published: ``tracings.json``, ``drawings.json`` and ``drawings_registered.json``, each
``{"IMAGE.png": {"PARTICIPANT": [{"path": "t,x,y,t,x,y…", "pressure", "color", "width", "opacity"}]}}`` on a
sheet of 800 x 800, widths in its pixels. The prompts are pictures; for those that show a mesh no camera was
found published, so meshes and cameras come from ``cameras.json``, whose views are named like the prompts.
Tracings of other origin fit this layout too.
"""

from pathlib import Path
from typing import Any

import numpy as np

from normalgan.benchmark.human.cameras import Registered, read_cameras
from normalgan.benchmark.human.drawing import Found, HumanDrawing, read_json, stroke_of
from normalgan.errors import InputError
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["is_tracings", "read_tracings"]

_FILES = {
    "tracings.json": "traced",
    "drawings_registered.json": "freehand registered",
    "drawings.json": "freehand",
}
_SIDE = 800


def is_tracings(folder: Path) -> bool:
    """Return whether a folder is laid out like this."""
    return any((folder / name).is_file() for name in _FILES)


def read_tracings(folder: Path) -> Found:
    """Return the drawings in a folder.

    Raises:
        InputError: if a file or ``cameras.json`` cannot be used.
    """
    views = {Path(name).stem: view for name, view in read_cameras(folder).items()}
    drawings, left_out = [], []
    for file, group in _FILES.items():
        if not (folder / file).is_file():
            continue
        content = read_json(folder / file)
        if not isinstance(content, dict):
            raise InputError(f'{folder / file} is not laid out like {{"IMAGE.png": {{"PARTICIPANT": […]}}}}.')
        without = sorted(image for image in content if Path(image).stem not in views)
        if without:
            left_out.append(
                f"{file}: of {len(without)} of {len(content)} prompts cameras.json has no view, such as "
                f"{without[0]}; they are left out."
            )
        for image in sorted(content.keys() - set(without)):
            if not isinstance(content[image], dict):
                left_out.append(f"{file}: {image} is left out: it has no drawings by participant.")
                continue
            for person, strokes in sorted(content[image].items()):
                what = f"{file}: {image} by {person}"
                try:
                    drawings.append(_read(strokes, group, image, person, what, views[Path(image).stem]))
                except InputError as error:
                    left_out.append(f"{what} is left out: {error}")
    return Found("Tracing versus Freehand", drawings, left_out)


def _read(strokes: Any, group: str, image: str, person: str, what: str, view: Registered) -> HumanDrawing:
    try:
        drawn = [stroke for one in strokes if (stroke := _stroke(one, what))]
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"it is not laid out like a drawing of this set ({error}).") from error
    kind = group.replace(" ", "_")
    name = f"{view.mesh.stem}/{Path(image).stem}_{person}_{kind}"
    return HumanDrawing(name, group, drawn, _SIDE, view.mesh, view.projection)


def _stroke(one: dict[str, Any], what: str) -> Stroke | None:
    numbers = np.array([float(value) for value in one["path"].split(",") if value.strip()])
    places = numbers[: len(numbers) // 3 * 3].reshape(-1, 3)[:, 1:]
    return stroke_of(places, float(one.get("width", 1)), float(one.get("opacity", 1)), what)
