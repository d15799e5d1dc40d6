"""Cells: where the drawings of a sheet lie, and how they are turned."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from normalgan.inference.reading.hint_files import Hints

__all__ = ["Cell"]

T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True)
class Cell:
    """Where one drawing lies in a sheet.

    Args:
        name: what to call it.
        left: first column.
        top: first row.
        width: columns in the sheet.
        height: rows in the sheet.
        turned: quarters by which it lies in the sheet turned clockwise, as packers do to save room.
        own: (height, width), what of the box is its own; None if all is.
    """

    name: str
    left: int
    top: int
    width: int
    height: int
    turned: int = 0
    own: NDArray[np.bool_] | None = None

    @property
    def box(self) -> tuple[slice, slice]:
        """Rows and columns of the sheet."""
        return slice(self.top, self.top + self.height), slice(self.left, self.left + self.width)

    def upright(self, part: NDArray[T]) -> NDArray[T]:
        """Return its part of a sheet, (height, width, ...), as it was drawn."""
        return np.rot90(part, self.turned) if self.turned else part

    def turn(self, part: NDArray[T]) -> NDArray[T]:
        """Return an upright array as it lies in the sheet; directions in it are not turned along."""
        return np.rot90(part, -self.turned) if self.turned else part

    def local(self, hints: Hints) -> Hints | None:
        """Return those of a sheet's hints that lie in it, in its own upright pixels; None if none does."""
        x, y = hints.points.T - np.array([[self.left], [self.top]], np.float32)
        inside = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
        if not inside.any():
            return None
        width, height = self.width, self.height
        for _ in range(self.turned):
            x, y, width, height = y, width - x, height, width
        points = np.stack([x, y], -1)
        return Hints(points[inside].astype(np.float32), hints.normals[inside])

    def put(self, whole: NDArray[T], part: NDArray[T]) -> None:
        """Write an upright array, (height, width, ...), into its part of a sheet's, where that is its own."""
        there = np.s_[:] if self.own is None else self.own
        whole[self.box][there] = self.turn(part)[there]
