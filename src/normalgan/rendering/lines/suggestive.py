"""Suggestive contours: occluding contours and the strokes that would become so from nearby."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.arrays import Floats
from normalgan.ranges import NonNegative, Positive, PositiveInt, Range, check_ranges
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.crossings import Line
from normalgan.rendering.lines.outlined import OutlinedDrawing
from normalgan.rendering.lines.pens import draw_curve
from normalgan.rendering.lines.valleys import smooth_normals, valley_depth, zero_crossings
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["SuggestiveContours"]

_BAND = 0.003  # of the frame's side: normals this near a contour are mixed from two surfaces


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class SuggestiveContours(OutlinedDrawing):
    """Occluding contours and a few confident strokes inside; of all styles, the closest to an artist's.

    The strokes are the suggestive contours of DeCarlo et al. 2003, found in the picture: zero crossings
    of D_w f where D_w D_w f > t, for f = n·v and w the projection of the view vector v to the surface,
    on smoothed normals.

    Args:
        line_width: width of contours in pixels of the sketch, at any sketch size.
        interior_width: width of the strokes inside in pixels of the sketch; 0 draws none.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side.
        smoothing: standard deviation of the smoothing of the normals, as a fraction of the frame's side.
        strength: how sharp a valley must be for a stroke: t for a frame of side 1; a stroke that has begun
            continues down to a third of it.
        theta: degrees between normal and view vector below which no stroke is drawn.
        shortest_contour: contours that span less than this fraction of the frame's side are left out.
        shortest: strokes inside that span less than this fraction of the frame's side are left out.
        apart: a stroke that keeps nearer than this to a contour, on average, as a fraction of the
            frame's side, is left out: it would only double the contour.
        resolution: side in pixels of the maps that lines are found in, rounded up to a multiple of the
            sketch's; lines are placed between their pixels.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: Positive = 1.25
    interior_width: NonNegative = 0.75
    gap: Positive = 0.01
    smoothing: Positive = 0.008
    strength: Positive = 20.0
    theta: Annotated[float, Range(0, 90, below=True)] = 28.0
    shortest_contour: NonNegative = 0.012
    shortest: NonNegative = 0.035
    apart: NonNegative = 0.012
    resolution: PositiveInt = 512

    def __post_init__(self) -> None:
        check_ranges(self)

    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the suggestive contours; see `OutlinedDrawing._draw_inside`."""
        return [
            draw_curve(line, buffers, self.interior_width)
            for line in self._inside(buffers, distance)
            if self._says_more(line, distance, buffers.side)
        ]

    def _inside(self, buffers: Buffers, distance: Floats) -> list[Line]:
        """Return the lines inside, given each pixel's ``distance`` to the contours."""
        side = buffers.side
        known = buffers.maps.mask & (distance > _BAND * side)
        normal = smooth_normals(buffers.maps.normal, known, self.smoothing * side)
        f, slope, bend = valley_depth(normal, buffers.sight)
        bend *= side * side
        deep = known & (f < np.cos(np.deg2rad(self.theta))) & (bend > self.strength / 3)
        return zero_crossings(slope, bend, deep).lines(self.strength, self.shortest * side)

    def _says_more(self, line: Line, distance: Floats, side: int) -> bool:
        """Return whether a line keeps away from contours; next to a contour it would only double it."""
        return bool(distance[tuple(line.pixels.T)].mean() > self.apart * side)
