"""Thinning: from inked areas to their centre lines and widths."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Indices
from normalgan.rendering.strokes.chain import chain

__all__ = ["thin", "without_specks"]


def without_specks(inked: BoolMask, shortest: float) -> BoolMask:
    """Return the inked pixels (H, W) without connected patches that span less than ``shortest`` pixels.

    The extent of a patch is the longer side of its bounding box; corners connect.

    >>> without_specks(np.array([[1, 1, 1, 0, 1]], bool), 2).astype(int)
    array([[1, 1, 1, 0, 0]])
    """
    _, labels, stats, _ = cv2.connectedComponentsWithStats(inked.astype(np.uint8), connectivity=8)
    large = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT]) >= shortest
    large[0] = False
    kept: BoolMask = large[labels]
    return kept


def thin(inked: BoolMask) -> list[tuple[Doubles, Doubles]]:
    """Return the lines along the middle of inked areas, and how thick the ink is there.

    Zhang and Suen, "A Fast Parallel Algorithm for Thinning Digital Patterns", 1984, as scikit-image has it.

    Args:
        inked: (H, W).

    Returns:
        For each line its points (P, 2), x right and y down in pixels, and widths (P,) in pixels.

    >>> inked = np.zeros((9, 20), bool)
    >>> inked[3:6, 2:18] = True
    >>> [(points, width)] = thin(inked)
    >>> points[5:8].tolist(), width[5:8].tolist()
    ([[11.5, 4.5], [10.5, 4.5], [9.5, 4.5]], [3.0, 3.0, 3.0])
    """
    from skimage.morphology import skeletonize  # takes half a second, and only brushes need it

    skeleton: BoolMask = skeletonize(inked)
    rows, columns = np.nonzero(skeleton)
    if not len(rows):
        return []
    # The distance from a pixel's centre to the nearest centre without ink is half a pixel beyond the ink.
    depth = cv2.distanceTransform(np.pad(inked, 1).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    width = 2 * depth[1:-1, 1:-1][rows, columns].astype(np.float64) - 1
    points = np.stack([columns + 0.5, rows + 0.5], axis=1)
    links = _neighbours(skeleton, rows, columns)
    return [(points[path], width[path]) for path in (chain(points, links) if len(links) else [])]


def _neighbours(skeleton: BoolMask, rows: Indices, columns: Indices) -> Indices:
    """Return pairs of neighbours on a skeleton, (L, 2); corner to corner only if no side joins them."""
    number = np.full((skeleton.shape[0] + 2, skeleton.shape[1] + 2), -1)
    number[rows + 1, columns + 1] = np.arange(len(rows))
    links = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        other = number[rows + 1 + down, columns + 1 + right]
        near = other >= 0
        if down and right:
            near &= (number[rows + 2, columns + 1] < 0) & (number[rows + 1, columns + 1 + right] < 0)
        links.append(np.stack([np.flatnonzero(near), other[near]], axis=1))
    return np.concatenate(links)
