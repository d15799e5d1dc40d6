"""Occluding contours: the outline, and every edge where one part hides another."""

from dataclasses import dataclass

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.checks import check_maps, check_settings
from normalgan.rendering.lines.edges import creases, depth_gaps
from normalgan.rendering.lines.sight import Sight, estimate_sight
from normalgan.rendering.lines.strokes import Mark, average_down, crop, distance_to, grow, ink, object_window
from normalgan.rendering.maps import Floats, Maps


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class OccludingContours(LineDrawing):
    """Silhouette and occluding contours, and the creases of angular objects if asked for.

    Args:
        line_width: width of a line in pixels of the sketch, whatever its size.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side; a contour once begun goes on down to a third of it.
        crease: angle in degrees between neighbouring normals from which an edge is drawn; None draws none.
        shortest: contours that span less than this fraction of the frame's side are left out.
        supersampling: the maps are this many times larger than the sketch.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: float = 1.25
    gap: float = 0.01
    crease: float | None = None
    shortest: float = 0.012
    supersampling: int = 4

    def __post_init__(self) -> None:
        check_settings(self, positive=("line_width", "gap", "supersampling"))
        if self.crease is not None and not 0 < self.crease < 180:
            raise InputError(f"crease is {self.crease}; it is an angle between 0 and 180 degrees, or null.")

    def draw(self, maps: Maps, size: int) -> Floats:
        """Return the sketch; see `LineDrawing.draw`."""
        check_maps(maps, size, self.supersampling)
        if not maps.mask.any():
            return np.zeros((size, size), np.float32)
        width = self.line_width * self.supersampling
        window = object_window(maps.mask, int(np.ceil(width)), self.supersampling)
        part, side = crop(maps, window), maps.mask.shape[0]
        marks = occluding_contours(part, estimate_sight(part), self.gap * side, self.shortest * side)
        if self.crease is not None:
            folds = creases(part, self.crease)
            marks |= grow(folds, folds, self.shortest * side)
        return average_down(ink(distance_to(marks), width), window, self.supersampling, size)


def occluding_contours(maps: Maps, sight: Sight, gap: float, shortest: float) -> Mark:
    """Return the (H, W) pixels that hide something behind them; lengths in pixels."""
    gaps = depth_gaps(maps, sight, gap / 3)
    return grow(gaps > gap, gaps > gap / 3, shortest)
