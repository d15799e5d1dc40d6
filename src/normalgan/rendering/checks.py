"""Checks of the output of data sources, renderers and line styles, which may be third-party classes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["check_maps", "check_mesh", "check_strokes"]


def check_mesh(loaded: object) -> Mesh:
    """Return a data source's mesh after checking it.

    Raises:
        InputError: otherwise.
    """
    if not isinstance(loaded, Mesh):
        raise InputError(
            f"its load gave {type(loaded).__name__}; what is rendered is a normalgan.rendering.Mesh."
        )
    for part, wanted, kind in (
        ("vertices", "(V, 3) finite floats", np.floating),
        ("faces", "(F, 3) whole numbers", np.integer),
        ("normals", "(V, 3) finite floats", np.floating),
    ):
        if not _is_rows_of_three(getattr(loaded, part), kind):
            raise InputError(f"its load gave a Mesh whose {part} are not an array of {wanted}.")
    if len(loaded.normals) != len(loaded.vertices):
        raise InputError(
            f"its load gave a Mesh of {len(loaded.vertices)} vertices and {len(loaded.normals)} normals; "
            "each vertex has one."
        )
    if loaded.faces.min() < 0 or loaded.faces.max() >= len(loaded.vertices):
        raise InputError(
            f"its load gave a Mesh whose faces name the vertices {loaded.faces.min()} to "
            f"{loaded.faces.max()}; it has 0 to {len(loaded.vertices) - 1}."
        )
    return loaded


def _is_rows_of_three(value: object, kind: type[np.generic]) -> bool:
    if not isinstance(value, np.ndarray):
        return False
    array: NDArray[Any] = value
    shaped = array.ndim == 2 and array.shape[-1] == 3 and len(array) > 0
    return shaped and np.issubdtype(array.dtype, kind) and bool(np.isfinite(array).all())


def check_maps(renderer: object, maps: object, size: int) -> Maps:
    """Return a renderer's maps after checking that they have ``size`` pixels a side.

    Raises:
        InputError: otherwise.
    """
    name = type(renderer).__name__
    if not isinstance(maps, Maps):
        raise InputError(f"{name} gave {type(maps).__name__}; a renderer gives normalgan.rendering.Maps.")
    for part, wanted in (("normal", (size, size, 3)), ("depth", (size, size)), ("mask", (size, size))):
        value: object = getattr(maps, part)
        if not isinstance(value, np.ndarray) or value.shape != wanted:
            given = f"shape {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__
            raise InputError(f"{name} gave a {part} of {given}; here it is an array of shape {wanted}.")
    if maps.mask.dtype != np.bool_:
        raise InputError(f"{name} gave a mask of {maps.mask.dtype}; it is bool, True on the object.")
    if not np.isfinite(maps.normal).all():
        raise InputError(f"{name} gave normals that are not numbers; give unit vectors, 0 off the object.")
    return maps


def check_strokes(style: object, strokes: object, size: int) -> Sequence[Stroke]:
    """Return a line style's strokes after checking them for a picture of ``size`` pixels a side.

    Raises:
        InputError: otherwise. Strokes far outside are refused, not clipped, because drawing
            costs time and memory for every pixel along a line.
    """
    name = type(style).__name__
    asked, given = "a line style gives a list of Stroke", type(strokes).__name__
    if not isinstance(strokes, list | tuple):
        raise InputError(f"{name} gave {given}; {asked}.")
    if others := [type(each).__name__ for each in strokes if not isinstance(each, Stroke)]:
        raise InputError(f"{name} gave {given} of {others[0]}; {asked}.")
    for stroke in strokes:
        for part in ("points", "width", "darkness"):
            if not np.isfinite(getattr(stroke, part)).all():
                raise InputError(f"{name} gave a stroke whose {part} are not numbers; they must be finite.")
        low, high = float(stroke.points.min()), float(stroke.points.max())
        if low < -size or high > 2 * size or not 0 <= stroke.width.min() <= stroke.width.max() <= 4 * size:
            raise InputError(
                f"{name} gave a stroke from {low:.6g} to {high:.6g} pixels, up to "
                f"{stroke.width.max():.6g} wide, for a sketch of {size}; points and widths are in its pixels."
            )
    return strokes
