"""cameras.json: meshes and cameras of data sets that publish drawings alone, in a layout of ours.

``{"VIEW": {"mesh": "meshes/cat.obj", "projection": [[…4], […4], […4]]}}``: files are relative to the JSON,
and the projection leads from the mesh file's coordinates to pixels of the drawing, y downwards.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from normalgan.arrays import Doubles
from normalgan.benchmark.human.drawing import read_json
from normalgan.errors import InputError

__all__ = ["CAMERAS", "Registered", "read_cameras"]

CAMERAS = "cameras.json"


@dataclass(frozen=True)
class Registered:
    """A view that was drawn.

    Args:
        mesh: file of the object.
        projection: (3, 4) from its coordinates to pixels.
    """

    mesh: Path
    projection: Doubles


def read_cameras(folder: Path) -> dict[str, Registered]:
    """Return the views by name.

    Raises:
        InputError: if the file is missing or cannot be used.
    """
    path = folder / CAMERAS
    right = 'it must be like {"VIEW": {"mesh": "cat.obj", "projection": [[…4], […4], […4]]}}'
    if not path.is_file():
        raise InputError(f"{folder} has drawings but no {CAMERAS}, which says what they show; {right}.")
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is no list of views; {right}.")
    views = {}
    for name, view in content.items():
        try:
            projection = np.array(view["projection"], np.float64).reshape(3, 4)
            views[name] = Registered(path.parent / str(view["mesh"]), projection)
        except (LookupError, TypeError, ValueError):
            raise InputError(f"the view {name} in {path} cannot be used; {right}.") from None
    return views
