"""Suggestive contours: occluding contours and the strokes that would become so from nearby."""

from dataclasses import dataclass

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.checks import check_maps, check_settings
from normalgan.rendering.lines.occluding import occluding_contours
from normalgan.rendering.lines.sight import Sight, estimate_sight
from normalgan.rendering.lines.strokes import (
    Mark,
    average_down,
    crop,
    distance_to,
    grow,
    ink,
    object_window,
    without_doubles,
)
from normalgan.rendering.lines.valleys import smooth_normals, valley_depth, zero_crossings
from normalgan.rendering.maps import Floats, Maps

_BAND = 0.003  # of the frame's side: normals so near a contour are half seen, and of two surfaces


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class SuggestiveContours(LineDrawing):
    """Occluding contours and few, confident strokes inside, the most like an artist's of the styles.

    The strokes are the suggestive contours of DeCarlo et al. 2003, found in the picture: zero crossings
    of D_w f where D_w D_w f > t, for f = n·v and w the projection of the view vector v to the surface,
    on smoothed normals.

    Args:
        line_width: width of contours in pixels of the sketch, whatever its size.
        interior_width: width of the strokes inside in pixels of the sketch; 0 draws none.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side.
        smoothing: standard deviation of the smoothing of the normals, as a fraction of the frame's side.
        strength: how sharp a valley must be for a stroke: t for a frame of side 1; a stroke once begun
            goes on down to a third of it.
        theta: degrees between normal and view vector below which no stroke is drawn.
        shortest_contour: contours that span less than this fraction of the frame's side are left out.
        shortest: strokes inside that span less than this fraction of the frame's side are left out.
        apart: a stroke that keeps nearer than this to a contour, on average, as a fraction of the
            frame's side, is left out: it would only double the contour.
        supersampling: the maps are this many times larger than the sketch.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: float = 1.25
    interior_width: float = 0.75
    gap: float = 0.01
    smoothing: float = 0.008
    strength: float = 20.0
    theta: float = 28.0
    shortest_contour: float = 0.012
    shortest: float = 0.035
    apart: float = 0.012
    supersampling: int = 4

    def __post_init__(self) -> None:
        check_settings(self, positive=("line_width", "gap", "smoothing", "strength", "supersampling"))
        if not 0 <= self.theta < 90:
            raise InputError(f"theta is {self.theta}; it is an angle from 0 to below 90 degrees.")

    def draw(self, maps: Maps, size: int) -> Floats:
        """Return the sketch; see `LineDrawing.draw`."""
        check_maps(maps, size, self.supersampling)
        if not maps.mask.any():
            return np.zeros((size, size), np.float32)
        width = self.line_width * self.supersampling
        window = object_window(maps.mask, int(np.ceil(width)), self.supersampling)
        part, side = crop(maps, window), maps.mask.shape[0]
        sight = estimate_sight(part)
        contours = occluding_contours(part, sight, self.gap * side, self.shortest_contour * side)
        distance = distance_to(contours)
        strokes = without_doubles(self._strokes(part, sight, distance, side), distance, self.apart * side)
        fine = ink(distance_to(strokes), self.interior_width * self.supersampling)
        drawn = np.maximum(ink(distance, width), fine)
        return average_down(drawn, window, self.supersampling, size)

    def _strokes(self, maps: Maps, sight: Sight, distance: Floats, side: int) -> Mark:
        """Return the pixels of the strokes inside; ``side`` is the frame's, in pixels."""
        known = maps.mask & (distance > _BAND * side)
        normal = smooth_normals(maps.normal, known, self.smoothing * side)
        f, slope, bend = valley_depth(normal, sight)
        bend *= side * side
        deep = known & (f < np.cos(np.deg2rad(self.theta))) & (bend > self.strength / 3)
        return grow(bend > self.strength, zero_crossings(slope, deep), self.shortest * side)
