"""Stroke: a line drawn by a pen, as a curve before rasterisation."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from normalgan.arrays import Doubles


@dataclass(frozen=True)
class Stroke:
    """A line drawn by a pen, from its first point to its last.

    Args:
        points: (P, 2) points, x right and y down in pixels of the sketch, P at least 2. The pixel in row r
            and column c covers x from c to c + 1 and y from r to r + 1. A closed stroke ends with its
            first point.
        width: (P,) width of the line at each point, in pixels of the sketch.
        darkness: (P,) darkness of the ink at each point, from 0 (paper) to 1.

    Raises:
        ValueError: if the shapes of the arrays do not match.
    """

    points: Doubles
    width: Doubles
    darkness: Doubles

    def __post_init__(self) -> None:
        count = len(self.points)
        if count < 2 or self.points.shape != (count, 2):
            raise ValueError(f"a stroke has (P, 2) points, P at least 2, not {self.points.shape}")
        if self.width.shape != (count,) or self.darkness.shape != (count,):
            raise ValueError(
                f"{count} points, but width {self.width.shape} and darkness {self.darkness.shape}"
            )

    @classmethod
    def even(cls, points: Doubles, width: float, darkness: float = 1.0) -> Self:
        """Return a stroke with constant width and darkness.

        >>> Stroke.even(np.array([[0.0, 0.0], [3.0, 4.0]]), width=1.25).length
        5.0
        """
        return cls(points, np.full(len(points), width), np.full(len(points), darkness))

    @property
    def closed(self) -> bool:
        """Whether the stroke ends where it begins."""
        return len(self.points) > 2 and bool(np.array_equal(self.points[0], self.points[-1]))

    @property
    def length(self) -> float:
        """Length of the stroke in pixels of the sketch."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())
