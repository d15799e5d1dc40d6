"""Where the surface breaks off: silhouette, occluding contours and creases, as marks on pixels."""

import numpy as np
from numpy.typing import NDArray

from normalgan.rendering.lines.sight import Sight
from normalgan.rendering.lines.strokes import Mark
from normalgan.rendering.maps import Floats, Maps

Index = NDArray[np.intp]
Pixels = tuple[Index, Index]

_GRAZING = 0.1  # the least cosine a tangent plane is trusted with: beyond, it would explain any gap
_BAND = 2  # a flank this narrow, in pixels, is a contour: it is thinner than the line that would be drawn
_BEYOND = np.float32(1e6)  # depth of the background, in units of the mesh: farther than any object

PAIRS = (
    ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
    ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
)
"""Each pixel and its right neighbour, each pixel and the one below it."""


def depth_gaps(maps: Maps, sight: Sight, least: float) -> Floats:
    """Return how far the surface jumps back behind each pixel, (H, W) in pixels of its own size.

    Between two neighbours the depth may change by anything between what the tangent plane of the one
    and of the other foretells, and what it changes by a little off on either side; only what exceeds that
    is a gap. So flanks seen at a grazing angle stay free of ink, even where the interpolated normals of
    a coarse mesh deny that they are grazing. The gap is noted on the nearer pixel, the one that hides.
    Huge where that pixel borders on the background, 0 where nothing is hidden; the frame's border hides
    nothing.

    Args:
        maps: the object.
        sight: its pixels' sizes and rays.
        least: gaps of fewer pixels than this, positive, may be returned as 0; hardly any pair of pixels
            remains to be looked at.
    """
    gaps = np.zeros_like(maps.depth)
    depth = np.where(maps.mask, maps.depth, _BEYOND)
    floor = least * np.where(maps.mask, sight.pixel, 0)
    for axis, (one, two) in enumerate(PAIRS):
        wide = np.abs(depth[two] - depth[one]) > np.maximum(floor[one], floor[two])
        rows, columns = np.nonzero(wide)
        # Pixels in a row: the pair and, some way off on both sides, two more pairs.
        ahead = (-_BAND, 1 - _BAND, 0, 1, _BAND, _BAND + 1)
        line = [_moved(rows, columns, k, axis, depth.shape) for k in ahead]
        steps = [depth[line[k + 1]] - depth[line[k]] for k in (0, 2, 4)]
        pair = line[2:4]
        excuses = [np.where(np.abs(steps[k]) < _BEYOND / 2, steps[k], 0) for k in (0, 2)]
        excuses += [_foretold(maps, sight, pixel, axis) for pixel in pair]
        back, front = steps[1] - np.max(excuses, axis=0), np.min(excuses, axis=0) - steps[1]
        for pixel, gap in ((pair[0], back), (pair[1], front)):
            # Off the object, where a pixel has no size, nothing can hide anything.
            seen = maps.mask[pixel] & (gap > 0)
            at = (pixel[0][seen], pixel[1][seen])
            gaps[at] = np.maximum(gaps[at], gap[seen] / sight.pixel[at])
    return gaps


def _moved(rows: Index, columns: Index, by: int, axis: int, shape: tuple[int, ...]) -> Pixels:
    """Return indices moved to the right (axis 0) or down (1), but not out of an array of ``shape``."""
    down, right = (by, 0) if axis else (0, by)
    return (rows + down).clip(0, shape[0] - 1), (columns + right).clip(0, shape[1] - 1)


def _foretold(maps: Maps, sight: Sight, pixel: Pixels, axis: int) -> Floats:
    """Return by how much the tangent plane at each pixel deepens to the right (axis 0) or downwards (1)."""
    normal = maps.normal[pixel]
    towards = normal[:, 2] - normal[:, 0] * sight.x[pixel[1]] - normal[:, 1] * sight.y[pixel[0]]
    sign = (1, -1)[axis]  # the pixel below lies towards -y
    slope: Floats = sign * normal[:, axis] * sight.pixel[pixel] / np.maximum(towards, _GRAZING)
    return slope


def creases(maps: Maps, angle: float) -> Mark:
    """Return the (H, W) pixels across whose right or lower border the normal turns by ``angle`` degrees."""
    marks = np.zeros_like(maps.mask)
    for one, two in PAIRS:
        cosine = np.einsum("ijk,ijk->ij", maps.normal[one], maps.normal[two])
        marks[one] |= maps.mask[one] & maps.mask[two] & (cosine < np.cos(np.deg2rad(angle)))
    return marks
