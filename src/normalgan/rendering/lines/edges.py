"""Discontinuities between pixels: silhouette, occluding contours and creases."""

import numpy as np

from normalgan.arrays import BoolMask, Floats, Indices
from normalgan.rendering.lines.crossings import PAIRS, Crossed, Crossings, crossings, places
from normalgan.rendering.lines.sight import Sight
from normalgan.rendering.maps import Maps

__all__ = ["creases", "depth_gaps"]

_GRAZING = 0.1  # tangent planes with a smaller cosine are ignored: they would explain any gap
_BAND = 2  # pixels; a flank this narrow is a contour, because it is thinner than the line
_MUCH = 3.0  # ratio above which a gap counts as much larger
_BEYOND = np.float32(1e6)  # depth of the background, in units of the mesh: farther than any object


def depth_gaps(maps: Maps, sight: Sight, least: float) -> Crossings:
    """Return where the surface jumps back by at least ``least`` pixels of its own size, from pixel to pixel.

    The expected depth change between neighbours lies between the predictions of both tangent planes and the
    changes a few pixels away on either side; only an excess over that is a gap. So surfaces at a grazing
    angle get no ink, even where the interpolated normals of a coarse mesh look less steep. A gap belongs to
    the nearer, occluding pixel. Its strength is its size, and is huge next to the background. The frame's
    border occludes nothing.

    Args:
        maps: the object, (H, W).
        sight: its pixels' sizes and rays.
        least: positive, in pixels.
    """
    depth = np.where(maps.mask, maps.depth, _BEYOND)
    floor = np.where(maps.mask, sight.pixel, np.float32(0)) * np.float32(least)
    right, below = (_gaps_along(axis, depth, floor, maps, sight) for axis in (0, 1))
    return crossings((right, below), maps.mask.shape[1])


def _gaps_along(axis: int, depth: Floats, floor: Floats, maps: Maps, sight: Sight) -> Crossed:
    """Return the gaps between each pixel and its right neighbour (axis 0) or the one below (1)."""
    one, two = PAIRS[axis]
    # Only a few pairs of pixels remain to be checked.
    rows, columns = places(np.abs(depth[two] - depth[one]) > np.maximum(floor[one], floor[two]))
    # Pixels in a row: the pair, and another pair at some distance on each side.
    ahead = (-_BAND, 1 - _BAND, 0, 1, _BAND, _BAND + 1)
    line = [_moved(rows, columns, k, axis, depth.shape) for k in ahead]
    deep = [depth.ravel()[pixel] for pixel in line]
    step = deep[3] - deep[2]
    excuses = [deep[1] - deep[0], deep[5] - deep[4]]
    excuses = [np.where(np.abs(excuse) < _BEYOND / 2, excuse, 0) for excuse in excuses]
    excuses += [_foretold(maps, sight, pixel, axis) for pixel in line[2:4]]
    back, front = step - np.max(excuses, axis=0), np.min(excuses, axis=0) - step
    second = front > back
    nearer = np.where(second, line[3], line[2])
    gap, size = np.maximum(back, front), sight.pixel.ravel()[nearer]
    # Off the object pixels have no size, and nothing is hidden.
    seen = np.flatnonzero(maps.mask.ravel()[nearer] & (gap > floor.ravel()[nearer]))
    strength, second, first = gap[seen] / size[seen], second[seen], line[2][seen]
    # A strong edge is a contour, even just before the part behind it ends.
    weak = gap[seen] < _MUCH * floor.ravel()[nearer[seen]]
    kept = seen[~(weak & _outdone(np.where(second, -strength, strength), first, depth.shape, axis))]
    second, share = front[kept] > back[kept], np.full(len(kept), 0.5)
    return rows[kept], columns[kept], share, gap[kept] / size[kept], second


def _moved(rows: Indices, columns: Indices, by: int, axis: int, shape: tuple[int, ...]) -> Indices:
    """Return flat indices of pixels moved right (axis 0) or down (1), but not out of the picture."""
    if axis:
        rows = (rows + by).clip(0, shape[0] - 1)
    else:
        columns = (columns + by).clip(0, shape[1] - 1)
    flat: Indices = rows * shape[1] + columns
    return flat


def _foretold(maps: Maps, sight: Sight, pixel: Indices, axis: int) -> Floats:
    """Return the depth change of each pixel's tangent plane to the right (axis 0) or downwards (1)."""
    nx, ny, nz = maps.normal.reshape(-1, 3).take(pixel, axis=0).T
    row, column = np.divmod(pixel, maps.mask.shape[1])
    towards = nz - nx * sight.x[column] - ny * sight.y[row]
    across = -ny if axis else nx  # the pixel below lies towards -y
    slope: Floats = across * sight.pixel.ravel()[pixel] / np.maximum(towards, _GRAZING)
    return slope


def _outdone(falls: Floats, first: Indices, shape: tuple[int, ...], axis: int) -> BoolMask:
    """Return which jumps may be only the start or end of a much larger neighbouring jump in their row.

    Args:
        falls: (N,) how far the surface jumps back (positive) or forth (negative).
        first: (N,) flat index of the first pixel of each pair.
        shape: (H, W) of the picture.
        axis: 0 for horizontal pairs, 1 for vertical pairs.
    """
    stride = shape[1] if axis else 1
    there = np.zeros(shape[0] * shape[1] + 2 * stride, np.float32)
    there[first + stride] = falls
    sign = np.sign(falls)
    beside = [there[first + k * stride] * sign for k in (0, 2)]
    outdone: BoolMask = np.max(beside, axis=0) > _MUCH * np.abs(falls)
    return outdone


def creases(maps: Maps, angle: float) -> Crossings:
    """Return where the normal turns by ``angle`` degrees or more from pixel to pixel, within the object.

    Where it does so over several pixels in a row, the sharpest turn counts.
    """
    limit = np.cos(np.deg2rad(angle))
    pairs = []
    for axis, (one, two) in enumerate(PAIRS):
        cosine = np.einsum("ijk,ijk->ij", maps.normal[one], maps.normal[two])
        cosine[~(maps.mask[one] & maps.mask[two])] = 1
        sharpest = (cosine < limit) & _lowest(cosine, 1 - axis)
        rows, columns = np.nonzero(sharpest)
        share, second = np.full(len(rows), 0.5), np.zeros(len(rows), bool)
        pairs.append((rows, columns, share, 1 - cosine[sharpest], second))
    return crossings((pairs[0], pairs[1]), maps.mask.shape[1])


def _lowest(values: Floats, axis: int) -> BoolMask:
    """Return which values (H, W) are below the previous and not above the next one, along an axis."""
    padding = [(1, 1) if k == axis else (0, 0) for k in (0, 1)]
    padded = np.pad(values, padding, constant_values=np.inf)
    length = values.shape[axis]
    before, after = (padded.take(np.arange(k, k + length), axis) for k in (0, 2))
    lowest: BoolMask = (values < before) & (values <= after)
    return lowest
