"""The layout of DifferSketching (Xiao et al., ACM Transactions on Graphics 41(6), 2022).

Seen in the authors' programs: ``CATEGORY/original_json/P021_8_1_SAH_210.json`` and the same below
``global_json``, ``stroke_json`` and ``reg_json`` (drawings registered ever more closely); P is a professional
and N a novice; ``strokes`` have ``path`` in pixels of a sheet of 800 x 800 and ``draw_type``, of which 1 is
skipped; lines are drawn 3 pixels wide, and so they are here. Assumed: what follows the person in a file's
name is the view. Meshes and cameras were not found described anywhere, so they come from ``cameras.json``.
"""

import re
from pathlib import Path

from normalgan.benchmark.human.cameras import Registered, read_cameras
from normalgan.benchmark.human.drawing import Found, HumanDrawing, read_json, stroke_of
from normalgan.errors import InputError

__all__ = ["is_differsketching", "read_differsketching"]

_KINDS = ("original", "global", "stroke", "reg")
_NAME = re.compile(r"([NP])(\d+)_(.+)")
_SIDE, _WIDTH = 800, 3.0


def is_differsketching(folder: Path) -> bool:
    """Return whether a folder is laid out like this."""
    return any(True for kind in _KINDS for _ in folder.rglob(f"{kind}_json/*.json"))


def read_differsketching(folder: Path) -> Found:
    """Return the drawings in a folder.

    Raises:
        InputError: if there is no usable ``cameras.json``.
    """
    views = read_cameras(folder)
    drawings, left_out = [], []
    for kind in _KINDS:
        for path in sorted(folder.rglob(f"{kind}_json/*.json")):
            try:
                drawings.append(_read(path, kind, views))
            except InputError as error:
                left_out.append(str(error))
    return Found("DifferSketching", drawings, left_out)


def _read(path: Path, kind: str, views: dict[str, Registered]) -> HumanDrawing:
    match = _NAME.fullmatch(path.stem)
    if match is None:
        raise InputError(f"{path} is left out: it is not named like P021_8_1_SAH_210.json.")
    people, view = {"N": "novices", "P": "professionals"}[match[1]], match[3]
    if view not in views:
        raise InputError(f"{path} is left out: cameras.json has no view {view}.")
    content = read_json(path)
    try:
        kept = [one["path"] for one in content["strokes"] if one.get("draw_type", 0) != 1]
    except (LookupError, TypeError, AttributeError) as error:
        raise InputError(f"{path} is left out: it is not laid out like DifferSketching.") from error
    strokes = [stroke for one in kept if (stroke := stroke_of(one, _WIDTH, 1.0, str(path)))]
    at = views[view]
    name = f"{at.mesh.stem}/{kind}_{path.stem}"
    return HumanDrawing(name, f"{people} {kind}", strokes, _SIDE, at.mesh, at.projection)
