"""Occluding contours: the outline, and every edge where one part hides another."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.ranges import NonNegative, Positive, PositiveInt, Range, check_ranges
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.crossings import Line
from normalgan.rendering.lines.edges import creases, depth_gaps
from normalgan.rendering.lines.pens import draw_border
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["OccludingContours", "occluding_contours"]


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class OccludingContours(LineDrawing):
    """Silhouette and occluding contours, and the creases of angular objects if asked for.

    Args:
        line_width: width of a line in pixels of the sketch, at any sketch size.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side; a contour that has begun continues down to a third of it.
        crease: angle in degrees between neighbouring normals from which an edge is drawn; None draws none.
        shortest: contours that span less than this fraction of the frame's side are left out.
        resolution: side in pixels of the maps that lines are found in, rounded up to a multiple of the
            sketch's; lines are placed between their pixels.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: Positive = 1.25
    gap: Positive = 0.01
    crease: Annotated[float, Range(0, 180, above=True, below=True)] | None = None
    shortest: NonNegative = 0.012
    resolution: PositiveInt = 512

    def __post_init__(self) -> None:
        check_ranges(self)

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes; see `LineDrawing.trace`."""
        buffers = Buffers.of(view, self.resolution)
        if buffers is None:
            return []
        lines = occluding_contours(buffers, self.gap, self.shortest)
        if self.crease is not None:
            lines += creases(buffers.maps, self.crease).lines(0, self.shortest * buffers.side)
        return [draw_border(line, buffers, self.line_width) for line in lines]


def occluding_contours(buffers: Buffers, gap: float, shortest: float) -> list[Line]:
    """Return the occluding contours; lengths are fractions of the frame's side."""
    gap *= buffers.side
    return depth_gaps(buffers.maps, buffers.sight, gap / 3).lines(gap, shortest * buffers.side)
