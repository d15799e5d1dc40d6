"""HumanDrawing: strokes of a person, and the mesh and camera that he or she drew."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from normalgan.arrays import Doubles
from normalgan.errors import InputError, brief
from normalgan.files.limits import read_bounded
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["Found", "HumanDrawing", "read_json", "stroke_of"]

_LARGEST_SIDE = 4096
"""Longer drawings are a mistake: the map of one would take minutes."""


@dataclass(frozen=True)
class HumanDrawing:
    """A drawing of an object whose mesh and camera are known.

    Args:
        name: ``object/view and person``, unlike that of any other.
        group: those that are reported together, such as concept or presentation.
        strokes: in pixels from the upper left corner.
        side: of the square sheet in pixels.
        mesh: file of the object.
        projection: (3, 4) from the mesh file's coordinates to pixels.
        misses: by how many pixels the camera misses the points that it was fitted to; None if it is given.
    """

    name: str
    group: str
    strokes: list[Stroke]
    side: int
    mesh: Path
    projection: Doubles
    misses: float | None = None

    def __post_init__(self) -> None:
        if not self.strokes:
            raise InputError(f"{self.name} has no stroke of two points or more.")
        if not 8 <= self.side <= _LARGEST_SIDE:
            raise InputError(f"{self.name} is {self.side} pixels wide; 8 to {_LARGEST_SIDE} can be measured.")
        for stroke in self.strokes:
            low, high = float(stroke.points.min()), float(stroke.points.max())
            least, most = float(stroke.width.min()), float(stroke.width.max())
            seen = 0 < least <= most <= self.side and bool(np.isfinite(stroke.darkness).all())
            # What lies far outside is refused and not cut off: each pixel along a line takes time and memory.
            if low < -self.side or high > 2 * self.side or not seen:
                raise InputError(
                    f"{self.name} has a stroke from {low:.6g} to {high:.6g} pixels, {most:.6g} wide and "
                    f"{float(stroke.darkness.max()):.6g} dark, which cannot be on a sheet of {self.side}."
                )


@dataclass(frozen=True)
class Found:
    """What a reader found.

    Args:
        layout: name of the data set whose layout it is.
        drawings: in order of their names.
        left_out: a sentence for each that cannot be measured.
    """

    layout: str
    drawings: list[HumanDrawing]
    left_out: list[str]


def stroke_of(points: Any, width: float, darkness: float, what: str) -> Stroke | None:
    """Return a stroke of points; None if there are fewer than two places.

    Raises:
        InputError: if they are no numbers.
    """
    try:
        array = np.asarray(points, np.float64).reshape(-1, 2)
    except (TypeError, ValueError):
        raise InputError(f"{what} has a stroke whose points are no pairs of numbers.") from None
    if not np.isfinite(array).all():
        raise InputError(f"{what} has a stroke with a coordinate that is not a finite number.")
    moved = np.r_[True, (np.diff(array, axis=0) != 0).any(axis=1)] if len(array) else np.zeros(0, bool)
    array = array[moved]
    return Stroke.even(array, float(width), float(np.clip(darkness, 0, 1))) if len(array) > 1 else None


def read_json(path: Path) -> Any:
    """Return what a JSON file says.

    Raises:
        InputError: if it cannot be read.
    """
    try:
        return json.loads(read_bounded(path))
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or brief(error)}.") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path} is not JSON: {brief(error)}.") from error
