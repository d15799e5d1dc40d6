"""Orientation files: the rotation of each mesh in a folder, and whether it is inside out."""

from typing import Any, NamedTuple

import numpy as np

from normalgan.errors import InputError
from normalgan.files.json_files import read_json
from normalgan.files.shipped_configs import find_beside

__all__ = ["Orientation", "Rotation", "checked_rotation", "read_orientations"]

Rotation = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


class Orientation(NamedTuple):
    """The orientation of one mesh; see `MeshFile`."""

    rotation: Rotation | None
    inside_out: bool | None


def read_orientations(path: str) -> dict[str, Orientation]:
    """Return the orientations of a JSON file ``{"name": {"rotation": 3×3, "inside_out": bool}}``.

    Either entry may be missing: the mesh then keeps the rotation of its file, or its outside is detected.

    Raises:
        InputError: if the file cannot be read, is not of that form, or a matrix is not a rotation.
    """
    table = read_json(find_beside(path), "the orientation file")
    if not isinstance(table, dict):
        raise InputError(f"the orientation file {path} must hold an object with one entry a mesh.")
    return {name: _orientation(f"{path}, mesh {name!r}", entry) for name, entry in table.items()}


def _orientation(where: str, entry: Any) -> Orientation:
    if not isinstance(entry, dict) or not entry.keys() <= {"rotation", "inside_out"}:
        raise InputError(f"{where}: an orientation has 'rotation' and 'inside_out', and nothing else.")
    inside_out = entry.get("inside_out")
    if not isinstance(inside_out, bool | None):
        raise InputError(f"{where}: 'inside_out' is {inside_out!r}; it must be true or false.")
    rotation = entry.get("rotation")
    return Orientation(None if rotation is None else checked_rotation(where, rotation), inside_out)


def checked_rotation(where: str, rows: Any) -> Rotation:
    """Return the rotation nearest to a matrix that is one up to rounding.

    Args:
        where: name of the mesh or folder, for the message.
        rows: 3 rows of 3 numbers.

    Raises:
        InputError: if they are not, or if they mirror, scale or shear.

    Example:
        >>> checked_rotation("example", [[0, -1, 0], [1, 0, 0], [0, 0, 1]])[0]
        (0.0, -1.0, 0.0)
    """
    try:
        matrix = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError(f"{where}: 'rotation' must be 3 rows of 3 numbers, x' = R x.")
    # Files round to a few digits; a larger error than a thousandth is not rounding.
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-3 or np.linalg.det(matrix) < 0:
        raise InputError(
            f"{where}: 'rotation' is not a rotation; its rows must be orthonormal, its determinant 1."
        )
    left, _, right = np.linalg.svd(matrix)
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in left @ right + 0.0)
    return x, y, z
