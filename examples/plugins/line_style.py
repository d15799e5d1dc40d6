"""A line style, which traces strokes: curves with width and darkness. It needs only NumPy."""

from dataclasses import dataclass

import numpy as np

from normalgan.rendering.lines import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View
from normalgan.testing import check


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class Box(LineDrawing):
    """Draws the object's bounding box as one closed stroke.

    Args:
        line_width: width of the line in pixels of the sketch.
    """

    line_width: float = 1.25

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes, in pixels of the sketch."""
        rows, columns = np.nonzero(view.maps(2).mask)  # maps at twice the sketch's size, for half pixels
        if not len(rows):
            return []
        left, right = columns.min() / 2, (columns.max() + 1) / 2
        top, bottom = rows.min() / 2, (rows.max() + 1) / 2
        corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
        return [Stroke.even(np.array(corners), self.line_width)]


if __name__ == "__main__":
    check(Box())
