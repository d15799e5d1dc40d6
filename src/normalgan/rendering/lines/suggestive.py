"""Suggestive contours: occluding contours, and lines that would be contours from a nearby viewpoint."""

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

_BAND = 0.003  # fraction of the frame's side; normals within this distance of a contour mix two surfaces


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class SuggestiveContours(OutlinedDrawing):
    """Occluding contours and a few confident inner strokes; of all styles, the closest to an artist's.

    The inner strokes are the suggestive contours of DeCarlo et al. 2003, found in the picture. They are
    zero crossings of D_w f with D_w D_w f > t, where f = n·v and w is the projection of the view vector v
    onto the surface, for smoothed normals.

    Args:
        smoothing: standard deviation of the Gaussian applied to the normals, as a fraction of the frame's
            side.
        strength: minimum sharpness t of a valley at a stroke, for a frame of side 1. A stroke continues as
            long as it reaches a third of this.
        theta: minimum angle in degrees between normal and view vector at a stroke.
    """

    interior_width: NonNegative = 0.75
    smoothing: Positive = 0.008
    strength: Positive = 20.0
    theta: Annotated[float, Range(0, 90, below=True)] = 28.0
    shortest: NonNegative = 0.035

    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the suggestive contours; see `OutlinedDrawing._draw_inside`."""
        lines = self._inside(buffers, distance)
        # Lines beside a contour would only duplicate it.
        apart = [ln for ln in lines if distance[tuple(ln.pixels.T)].mean() > self.apart * buffers.side]
        return [draw_curve(line, buffers, self.interior_width) for line in apart]

    def _inside(self, buffers: Buffers, distance: Floats) -> list[Line]:
        """Return the inner lines, given each pixel's ``distance`` to the contours."""
        side = buffers.side
        known = buffers.maps.mask & (distance > _BAND * side)
        normal = _smooth_normals(buffers.maps.normal, known, self.smoothing * side)
        f, slope, bend = _valley_depth(normal, buffers.sight)
        bend *= side * side
        deep = known & (f < np.cos(np.deg2rad(self.theta))) & (bend > self.strength / 3)
        return _zero_crossings(slope, bend, deep).lines(self.strength, self.shortest * side)


_ROUNDING = 1e-6  # smaller slopes of n·v are rounding errors of single precision, and planes have no valleys


def _smooth_normals(normal: Floats, known: BoolMask, sigma: float) -> Floats:
    """Return unit normals (H, W, 3) smoothed over ``sigma`` pixels, using only ``known`` pixels.

    This is a normalised convolution. Background and contours are unknown, so neither the surface behind
    nor partly covered pixels leak in. The sum is normalised to unit length, so it need not be divided by
    the weights.
    """
    side = 2 * round(3 * sigma) + 1  # the default is a third larger, for only 0.3 % of the weight
    # One component at a time, so that each is contiguous in memory.
    weight = known.astype(np.float32)
    parts = np.empty((3, *known.shape), np.float32)
    for part, component in zip(parts, cv2.split(normal), strict=True):
        cv2.GaussianBlur(component * weight, (side, side), sigma, dst=part)
    length = np.sqrt(sum(part * part for part in parts))
    parts *= 1 / np.maximum(length, np.float32(1e-12))
    return np.moveaxis(parts, 0, -1)


def _valley_depth(normal: Floats, sight: Sight) -> tuple[Floats, Floats, Floats]:
    """Return f = n·v, its slope g in the viewing direction in the picture, and the slope of g, (H, W) each.

    The direction is that of w, the projection of the view vector v onto the tangent plane. Slopes are per
    pixel. Suggestive contours are where g crosses 0 upwards (DeCarlo, Finkelstein, Rusinkiewicz, Santella,
    "Suggestive Contours for Conveying Shape", SIGGRAPH 2003, section 2).
    """
    x, y = sight.x[None, :], sight.y[:, None]
    nx, ny, nz = normal[..., 0], normal[..., 1], normal[..., 2]
    f = sight.facing(normal)
    # A displacement e moves a point in the picture by (e_x + x e_z, e_y + y e_z), so v moves it by 0; w =
    # v - f n.
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
    """Return the sign changes of ``slope`` between two valid neighbours, with subpixel accuracy.

    Their strength is ``bend`` at the pixel closer to zero.
    """
    size, negative = np.abs(slope), slope < -_ROUNDING
    pairs = []
    for one, two in PAIRS:
        at = places((negative[one] != negative[two]) & valid[one] & valid[two])
        first, other = size[one][at], size[two][at]
        fraction = first / np.maximum(first + other, 1e-30)
        second = first > other
        strength = np.where(second, bend[two][at], bend[one][at])
        pairs.append((*at, fraction.astype(np.float64), strength, second))
    return crossings((pairs[0], pairs[1]), slope.shape[1])
