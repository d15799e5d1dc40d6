"""OutlinedDrawing: base of the styles that draw occluding contours and their own lines inside."""

from abc import abstractmethod

import numpy as np

from normalgan.arrays import Floats
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.marks import distance_to, mark
from normalgan.rendering.lines.occluding import occluding_contours
from normalgan.rendering.lines.pens import draw_border
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["OutlinedDrawing"]


class OutlinedDrawing(LineDrawing):
    """Draws the occluding contours, and leaves the lines inside to a style."""

    # Each style declares them with its own defaults, and documents them for the command line.
    line_width: float
    interior_width: float
    gap: float
    shortest_contour: float
    resolution: int

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes; see `LineDrawing.trace`."""
        buffers = Buffers.of(view, self.resolution)
        if buffers is None:
            return []
        contours = occluding_contours(buffers, self.gap, self.shortest_contour)
        strokes = [draw_border(line, buffers, self.line_width) for line in contours]
        if self.interior_width > 0:
            distance = distance_to(mark(contours, buffers.maps.mask.shape))
            strokes += self._draw_inside(view, buffers, distance)
        return strokes

    @abstractmethod
    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the strokes inside.

        Args:
            view: the object and where it is seen from.
            buffers: the maps that the contours were found in.
            distance: (H, W) of each pixel of the buffers to the nearest contour, in their pixels.
        """
