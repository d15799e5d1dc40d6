"""Silhouette: whether a drawing's transparency shows the object's outline or only its ink."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.regions import depth_of, extent_of

__all__ = ["contour", "enclosed_by", "is_silhouette"]

_THICK = 0.04
"""Half the width of an object at its widest, as a share of its extent; lines have less."""
_THICK_PARTS = ((0.12, 0.15), (0.16, 0.1))
"""Least span of a part that is an object, as a share of the whole extent; and its half width, of its span."""
_MANY, _ALIKE, _SPRITE, _ROUND = 4, 0.3, (8, 0.02), 0.2
"""Parts of like area from which they are sprites; the least share of the largest one's area; the least span
in pixels, and as a share of that of all; the least half width, as a share of the span: dashes have less."""


def is_silhouette(alpha: Floats) -> bool:
    """Return whether what is opaque (H, W) is an object and not just its lines.

    Lines enclose far more than they cover; an object covers what it encloses.

    >>> ring = np.zeros((32, 32), np.float32)
    >>> ring[4:28, 4:28] = 1
    >>> disc = ring.copy()
    >>> ring[6:26, 6:26] = 0
    >>> is_silhouette(disc), is_silhouette(ring)
    (True, False)
    """
    opaque = alpha > 0.5
    if opaque.mean() > 0.995:  # rounded corners, a torn edge: the sheet and no object
        return False
    covered, enclosed = int(opaque.sum()), int(enclosed_by(opaque).sum())
    if covered < 0.7 * enclosed:
        return False
    # Open lines enclose nothing but themselves; nowhere are they as thick as an object.
    depth, extent = depth_of(opaque, 3), extent_of(opaque)
    return float(depth.max()) > _THICK * extent or _thick_parts(opaque, depth, extent)


def _thick_parts(opaque: NDArray[np.bool_], depth: Floats, extent: int) -> bool:
    """Return whether most of what is opaque (H, W) lies in parts that are objects: the sprites of a sheet.

    Against all of the sheet none of them is thick; but against itself each is, and it is larger than a dash.
    """
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opaque.astype(np.uint8), connectivity=8)
    spans = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT])
    there = labels > 0
    owners, deepest = np.asarray(labels[there], np.int32), np.zeros(count, np.float32)
    np.maximum.at(deepest, owners, depth[there])
    objects = np.zeros(count, np.bool_)
    for large, thick in _THICK_PARTS:
        objects |= (spans > large * extent) & (deepest > thick * spans)
    areas = stats[:, cv2.CC_STAT_AREA]
    compact = (spans >= _SPRITE[0]) & (spans > _SPRITE[1] * extent) & (deepest > _ROUND * spans)
    compact[0] = False
    compact &= areas > _ALIKE * areas[compact].max(initial=0)
    if np.count_nonzero(compact) >= _MANY:
        objects |= compact
    return bool(areas[1:][objects[1:]].sum() > 0.5 * areas[1:].sum())


def enclosed_by(barrier: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the barrier (H, W) and all that cannot be reached past it from the picture's edge."""
    reached = cv2.copyMakeBorder(barrier.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    cv2.floodFill(reached, None, (0, 0), 2, flags=4)
    inside: NDArray[np.bool_] = reached[1:-1, 1:-1] != 2
    return inside


def contour(silhouette: NDArray[np.bool_]) -> Floats:
    """Return a line just inside a silhouette (H, W), about a 250th of its extent wide, ink 1."""
    width = max(extent_of(silhouette) / 250, 1.5)
    return np.where(silhouette, np.clip(width + 0.5 - depth_of(silhouette), 0, 1), 0).astype(np.float32)
