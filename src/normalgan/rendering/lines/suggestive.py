"""Suggestive contours: occluding contours and the strokes that would become so from nearby."""

from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.ranges import NonNegative, Positive, Range
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import Buffers, Sight
from normalgan.rendering.lines.contours import OutlinedDrawing, draw_curve
from normalgan.rendering.lines.crossings import PAIRS, Crossings, Line, crossings, places
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
        smoothing: standard deviation of the smoothing of the normals, as a fraction of the frame's side.
        strength: how sharp a valley must be for a stroke: t for a frame of side 1; a stroke that has begun
            continues down to a third of it.
        theta: degrees between normal and view vector below which no stroke is drawn.

    Raises:
        InputError: if a setting is out of range.
    """

    interior_width: NonNegative = 0.75
    smoothing: Positive = 0.008
    strength: Positive = 20.0
    theta: Annotated[float, Range(0, 90, below=True)] = 28.0
    shortest: NonNegative = 0.035

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
        normal = _smooth_normals(buffers.maps.normal, known, self.smoothing * side)
        f, slope, bend = _valley_depth(normal, buffers.sight)
        bend *= side * side
        deep = known & (f < np.cos(np.deg2rad(self.theta))) & (bend > self.strength / 3)
        return _zero_crossings(slope, bend, deep).lines(self.strength, self.shortest * side)

    def _says_more(self, line: Line, distance: Floats, side: int) -> bool:
        """Return whether a line keeps away from contours; next to a contour it would only double it."""
        return bool(distance[tuple(line.pixels.T)].mean() > self.apart * side)


_ROUNDING = 1e-6  # smaller slopes of n·v are rounding in single precision; planes have no valleys


def _smooth_normals(normal: Floats, known: BoolMask, sigma: float) -> Floats:
    """Return unit normals (H, W, 3) smoothed over ``sigma`` pixels, from those at ``known`` pixels alone.

    A normalised convolution: with background and contours not known, neither the far surface nor
    half-seen pixels leak in. (The sum needs no dividing by the weights: it is made a unit vector.)
    """
    side = 2 * round(3 * sigma) + 1  # by default a third more, for the last 0.3 % of the weight
    # One component after the other, so that each is contiguous in memory.
    weight = known.astype(np.float32)
    parts = np.empty((3, *known.shape), np.float32)
    for part, component in zip(parts, cv2.split(normal), strict=True):
        cv2.GaussianBlur(component * weight, (side, side), sigma, dst=part)
    length = np.sqrt(sum(part * part for part in parts))
    parts *= 1 / np.maximum(length, np.float32(1e-12))
    smooth: Floats = np.moveaxis(parts, 0, -1)
    return smooth


def _valley_depth(normal: Floats, sight: Sight) -> tuple[Floats, Floats, Floats]:
    """Return f = n·v, its slope g along the eye's direction in the picture, and the slope of g, (H, W) each.

    The direction is that of w, the projection of the view vector v to the tangent plane; g and its
    slope are per pixel. Suggestive contours are where g crosses 0 upwards (DeCarlo, Finkelstein,
    Rusinkiewicz, Santella, "Suggestive Contours for Conveying Shape", SIGGRAPH 2003, section 2).
    """
    x, y = sight.x[None, :], sight.y[:, None]
    nx, ny, nz = normal[..., 0], normal[..., 1], normal[..., 2]
    f = sight.facing(normal)
    # A displacement e moves a point's picture by e_x + x e_z, e_y + y e_z; w = v - f n, and v moves it by 0.
    right, down = -(nx + x * nz), ny + y * nz
    length = np.maximum(np.sqrt(right * right + down * down), np.float32(1e-12))
    right, down = right / length, down / length
    slope = _along(f, right, down)
    return f, slope, _along(slope, right, down)


def _along(field: Floats, right: Floats, down: Floats) -> Floats:
    """Return the derivative of a field along a unit direction, by central differences."""
    result = np.zeros_like(field)
    result[:, 1:-1] = (field[:, 2:] - field[:, :-2]) * right[:, 1:-1]
    result[1:-1] += (field[2:] - field[:-2]) * down[1:-1]
    result *= np.float32(0.5)
    return result


def _zero_crossings(slope: Floats, bend: Floats, valid: BoolMask) -> Crossings:
    """Return where ``slope`` changes sign between two valid neighbours, to a fraction of a pixel.

    Their strength is ``bend`` at the pixel nearer to zero.
    """
    size, negative = np.abs(slope), slope < -_ROUNDING
    pairs = []
    for one, two in PAIRS:
        at = places((negative[one] != negative[two]) & valid[one] & valid[two])
        first, other = size[one][at], size[two][at]
        share = first / np.maximum(first + other, 1e-30)
        second = first > other
        strength = np.where(second, bend[two][at], bend[one][at])
        pairs.append((*at, share.astype(np.float64), strength, second))
    return crossings((pairs[0], pairs[1]), slope.shape[1])
