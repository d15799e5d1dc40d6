"""Suggestive contours found in the picture: valleys of n·v along the direction of the eye."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.rendering.lines.crossings import PAIRS, Crossings, crossings, places
from normalgan.rendering.lines.sight import Sight

__all__ = ["smooth_normals", "valley_depth", "zero_crossings"]

_ROUNDING = 1e-6  # smaller slopes of n·v are rounding in single precision; planes have no valleys


def smooth_normals(normal: Floats, known: BoolMask, sigma: float) -> Floats:
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


def valley_depth(normal: Floats, sight: Sight) -> tuple[Floats, Floats, Floats]:
    """Return f = n·v, its slope g along the eye's direction in the picture, and the slope of g, (H, W) each.

    The direction is that of w, the projection of the view vector v to the tangent plane; g and its
    slope are per pixel. Suggestive contours are where g crosses 0 upwards (DeCarlo, Finkelstein,
    Rusinkiewicz, Santella, "Suggestive Contours for Conveying Shape", SIGGRAPH 2003, section 2).
    """
    x, y = sight.x[None, :], sight.y[:, None]
    nx, ny, nz = normal[..., 0], normal[..., 1], normal[..., 2]
    f = (nz - nx * x - ny * y) / np.sqrt(1 + x * x + y * y)
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


def zero_crossings(slope: Floats, bend: Floats, valid: BoolMask) -> Crossings:
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
