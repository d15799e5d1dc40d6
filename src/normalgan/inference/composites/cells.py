"""Cell: the position and rotation of a drawing in a sheet."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from normalgan.inference.network.tile import Tile
from normalgan.inference.reading.hint_files import Hints

T = TypeVar("T", bound=np.generic)
P = TypeVar("P", float, NDArray[np.float32])


@dataclass(frozen=True)
class Cell:
    """The position of a drawing in a sheet.

    Args:
        name: name of the drawing in messages.
        left: first column.
        top: first row.
        width: columns in the sheet.
        height: rows in the sheet.
        turned: rotation in the sheet, in clockwise quarter turns; packers rotate sprites to save space.
        own: (height, width), mask of the pixels that belong to the drawing; None for all.
        tile: the directions in which the drawing repeats; None if it does not.
    """

    name: str
    left: int
    top: int
    width: int
    height: int
    turned: int = 0
    own: NDArray[np.bool_] | None = None
    tile: Tile | None = None

    @property
    def box(self) -> tuple[slice, slice]:
        """The rows and columns of the sheet that the drawing occupies."""
        return slice(self.top, self.top + self.height), slice(self.left, self.left + self.width)

    def upright(self, part: NDArray[T]) -> NDArray[T]:
        """Return the cell's part of a sheet, (height, width, ...), rotated upright."""
        return np.rot90(part, self.turned) if self.turned else part

    def turn(self, part: NDArray[T]) -> NDArray[T]:
        """Return an upright array rotated as in the sheet; vectors in it keep their values."""
        return np.rot90(part, -self.turned) if self.turned else part

    def local(self, hints: Hints) -> Hints | None:
        """Return the sheet's hints in the cell, in upright pixels of the cell; None if there are none."""
        x, y = hints.points.T - np.array([[self.left], [self.top]], np.float32)
        inside = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
        if not inside.any():
            return None
        points = np.stack(self._upright_point(x, y), -1)
        return Hints(points[inside].astype(np.float32), hints.normals[inside])

    def points(self, given: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        """Return the sheet's points (x, y) in the cell, in upright pixels of the cell."""
        local = [(x - self.left, y - self.top) for x, y in given]
        inside = [
            (x, y)
            for x, y in local
            if 0 <= x < self.width and 0 <= y < self.height and (self.own is None or self.own[int(y), int(x)])
        ]
        return [self._upright_point(x, y) for x, y in inside]

    def in_sheet(self, points: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
        """Return points (x, y) in upright pixels of the cell in pixels of the sheet.

        >>> Cell("", 10, 20, 4, 8, turned=1).in_sheet([(2, 1)])
        ((13, 22),)
        """
        return tuple(self._sheet_point(x, y) for x, y in points)

    def _sheet_point(self, x: float, y: float) -> tuple[float, float]:
        """Convert x and y from upright pixels of the cell to pixels of the sheet."""
        height = self.width if self.turned % 2 else self.height
        for _ in range(self.turned):
            x, y, height = height - y, x, self.width + self.height - height
        return self.left + x, self.top + y

    def _upright_point(self, x: P, y: P) -> tuple[P, P]:
        """Convert x and y from pixels of the cell's box to upright pixels of the cell."""
        width, height = self.width, self.height
        for _ in range(self.turned):
            x, y, width, height = y, width - x, height, width
        return x, y

    def put(self, whole: NDArray[T], part: NDArray[T]) -> None:
        """Write an upright array (height, width, ...) into the cell's own pixels of a whole sheet."""
        there = np.s_[:] if self.own is None else self.own
        whole[self.box][there] = self.turn(part)[there]
