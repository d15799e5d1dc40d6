"""Hint files: read hints that are painted in a PNG or listed in JSON."""

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.files.limits import read_named
from normalgan.inference.reading.drawings import SUFFIXES, read_pixels, to_unit
from normalgan.normals import LEAST_Z, normalize, vectors

ENDINGS = ("_hints.png", "_hints.json", ".json", ".png")
"""Endings that follow a drawing's stem in the name of its hint file, in the order of the search."""
_MOST_LISTED = 2**24
"""Maximum size of a list of hints in bytes; each hint takes about 50."""

_OFF = 0.25
"""Maximum difference of a normal's length from 1."""

_Listed = tuple[float, float, tuple[float, float, float]]
"""x, y and the normal of a hint."""


@dataclass(frozen=True)
class Hints:
    """Normals at points of a drawing.

    Args:
        points: (K, 2), x right and y down in pixels; the centre of the first pixel is (0.5, 0.5).
        normals: (K, 3), unit normals in camera space.
    """

    points: Floats
    normals: Floats


def load_hints(path: Path, shape: tuple[int, int]) -> Hints:
    """Return the hints in a file for a drawing (H, W).

    Raises:
        InputError: if the file is invalid; the message says which hint is wrong.
    """
    if path.suffix.lower() == ".json":
        return parse_hints(_parsed(path), path, shape)
    if path.suffix and path.suffix.lower() not in SUFFIXES:
        raise InputError(f"the hints {path} are neither a list (.json) nor painted on a transparent PNG.")
    return _painted_hints(path, shape)


def _painted_hints(path: Path, shape: tuple[int, int]) -> Hints:
    """Return the hints that are painted in normal-map colours in a transparent PNG of the drawing's size."""
    pixels = read_pixels(path, exact=True).pixels
    if pixels.shape[:2] != shape:
        raise InputError(
            f"the hints {path} are {pixels.shape[1]} × {pixels.shape[0]} pixels, "
            f"but their sketch {shape[1]} × {shape[0]}."
        )
    if pixels.ndim == 2 or pixels.shape[2] < 4:
        raise InputError(f"the hints {path} have no transparency; paint them on a transparent PNG.")
    rows, columns = np.nonzero(to_unit(pixels[..., 3]) > 0.5)
    colours = pixels[rows, columns, :3]
    normals = vectors(colours)
    if fault := first_fault(normals):
        first, length = fault
        colour = f"the colour {colours[first].tolist()} at x {columns[first]}, y {rows[first]} of {path} is "
        if length is None:
            raise InputError(
                f"{colour}a normal that looks away from the viewer: its z is {normals[first, 2]:.2f}, and "
                "must be 0 or more."
            )
        half = {"uint8": 127.5, "uint16": 32767.5}.get(colours.dtype.name, 0.5)
        raise InputError(f"{colour}not a normal: (colour / {half} - 1) must have length 1, not {length:.2f}.")
    return hints_at(rows, columns, normals)


def first_fault(normals: Floats) -> tuple[int, float | None] | None:
    """Return the first vector (K, 3) that is not of length 1 and its length, or the first that faces away."""
    length = np.linalg.norm(normals, axis=1)
    wrong = np.flatnonzero(~(np.abs(length - 1) <= _OFF))  # written so that NaN counts as wrong
    if len(wrong):
        return int(wrong[0]), float(length[wrong[0]])
    away = np.flatnonzero(normals[:, 2] < LEAST_Z * length)
    return (int(away[0]), None) if len(away) else None


def hints_at(rows: NDArray[np.intp], columns: NDArray[np.intp], normals: Floats) -> Hints:
    """Return hints at the centres of pixels."""
    points = np.stack([columns, rows], axis=1).astype(np.float32) + np.float32(0.5)
    return Hints(points, normalize(normals))


def parse_hints(entries: Any, path: Path | str, shape: tuple[int, int]) -> Hints:
    """Return the hints in decoded JSON.

    Args:
        entries: a list such as ``[{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}, …]``, with x and y in whole
            pixels from the drawing's upper left corner.
        path: name of the list in error messages.
        shape: (H, W) of the drawing.

    Raises:
        InputError: if an entry is invalid.
    """
    if not isinstance(entries, list):
        raise InputError(
            f'the hints {path} are not a list; they are like [{{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}}].'
        )
    listed = list[_Listed]()
    for number, entry in enumerate(entries, 1):
        match entry:
            case {"x": x, "y": y, "normal": [nx, ny, nz]} if all(map(_is_number, (x, y, nx, ny, nz))):
                listed.append((x, y, (nx, ny, nz)))
            case _:
                raise InputError(
                    f"hint {number} of {path} is {json.dumps(entry, default=repr)[:80]}; a hint has x, y "
                    "and a normal of three numbers."
                )
    return check_hints(listed, path, shape)


def check_hints(listed: Iterable[_Listed], path: Path | str, shape: tuple[int, int]) -> Hints:
    """Check hints against a drawing and return them.

    Args:
        listed: x, y and normal of each hint, x and y in whole pixels from the drawing's upper left corner.
        path: name of the list in error messages.
        shape: (H, W) of the drawing.

    Raises:
        InputError: if a hint lies outside the drawing, or its normal is not of length 1 or faces away from
            the viewer.
    """
    points, normals = [], []
    for number, (x, y, (nx, ny, nz)) in enumerate(listed, 1):
        if not (0 <= x < shape[1] and 0 <= y < shape[0]):
            raise InputError(
                f"hint {number} of {path} lies at x {x:g}, y {y:g}, outside its drawing of "
                f"{shape[1]} × {shape[0]} pixels."
            )
        length = math.hypot(nx, ny, nz)
        if abs(length - 1) > _OFF:
            raise InputError(
                f"the normal [{nx:g}, {ny:g}, {nz:g}] of hint {number} of {path}, at x {x:g}, y {y:g}, "
                f"has length {length:.3g}; a normal has length 1."
            )
        if nz < LEAST_Z * length:
            raise InputError(
                f"the normal [{nx:g}, {ny:g}, {nz:g}] of hint {number} of {path}, at x {x:g}, y {y:g}, "
                "looks away from the viewer; its z must be 0 or more."
            )
        points.append((math.floor(x) + 0.5, math.floor(y) + 0.5))
        normals.append((nx, ny, nz))
    return Hints(
        np.array(points, np.float32).reshape(-1, 2), normalize(np.array(normals, np.float32).reshape(-1, 3))
    )


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:  # an integer beyond the range of floats
        return False


def _parsed(path: Path) -> Any:
    content = read_named(path, "the hints", _MOST_LISTED)
    try:
        return json.loads(content)  # detects the encoding of bytes, also with a byte order mark
    except json.JSONDecodeError as error:
        raise InputError(f"the hints {path} are not JSON: line {error.lineno}: {error.msg}.") from None
    except UnicodeDecodeError:
        raise InputError(f"the hints {path} are not text.") from None
    except (ValueError, RecursionError):  # a number with thousands of digits, or deeply nested lists
        raise InputError(f"the hints {path} are not a list of hints; they have unknown content.") from None
