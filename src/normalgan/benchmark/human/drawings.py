"""drawings.json: list drawings by people, each with a normal map, or with a mesh and a camera."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.files.json_files import read_json

_INDEX = "drawings.json"
_LAYOUT = (
    '{"OBJECT/PERSON": {"drawing": "a.png", "mesh": "a.obj", "projection": [[…4], […4], […4]]}}, or '
    '"normal": "a_normal.png" instead of mesh and projection'
)
_KEYS = {"drawing", "mesh", "projection", "normal", "group"}


@dataclass(frozen=True)
class HumanDrawing:
    """A drawing of an object with known normals.

    Args:
        name: ``object/person``, unique in its folder; intervals are computed over objects.
        group: name of the drawings that are reported together, such as concept or presentation.
        drawing: path of the picture.
        truth: path of the mesh, or of a normal map that is aligned with the drawing.
        projection: (3, 4), projection from the mesh file's coordinates to pixels of the drawing, y down; None
            for a normal map.
    """

    name: str
    group: str
    drawing: Path
    truth: Path
    projection: Doubles | None


def read_drawings(folder: Path) -> tuple[list[HumanDrawing], list[str]]:
    """Return the drawings listed in a folder's ``drawings.json``, and a message for each unusable entry.

    Raises:
        InputError: if the file does not exist or lists no usable drawing.
    """
    path = folder / _INDEX
    if not path.is_file():
        raise InputError(f"--human was given {folder}, which has no {_INDEX}; it must be like {_LAYOUT}.")
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a list of drawings by name; it must be like {_LAYOUT}.")
    drawings, left_out = [], []
    for name, entry in content.items():
        try:
            drawings.append(_drawing(folder, name, entry))
        except (LookupError, TypeError, ValueError):
            left_out.append(f"{name} in {path} is left out: its entry must be like {_LAYOUT}.")
    if not drawings:
        why = left_out[0] if left_out else "the file is empty."
        raise InputError(f"{folder} has no drawing that can be measured; {why}")
    return drawings, left_out


def _drawing(folder: Path, name: str, entry: Any) -> HumanDrawing:
    if not isinstance(entry, dict) or entry.keys() - _KEYS or ("normal" in entry) == ("mesh" in entry):
        raise ValueError
    kind = "normal" if "normal" in entry else "mesh"
    if ("projection" in entry) != (kind == "mesh"):
        raise ValueError
    projection = np.array(entry["projection"], np.float64).reshape(3, 4) if kind == "mesh" else None
    drawing, truth = (folder / str(entry[key]) for key in ("drawing", kind))
    return HumanDrawing(name, str(entry.get("group", "all")), drawing, truth, projection)
