"""Regions: bounding boxes, depths and enclosed areas of marked pixels."""

from collections.abc import Iterable
from typing import Literal

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats

Bounds = tuple[int, int, int, int]
"""First row, row after the last, first column, column after the last."""
INKED = 0.35
"""Minimum ink of a line that separates two areas."""


def box_of(marked: BoolMask) -> Bounds:
    """Return the bounding box of marked pixels (H, W); an empty box if there are none.

    >>> box_of(np.pad(np.ones((2, 3), bool), 1))
    (1, 3, 1, 4)
    """
    left, top, width, height = cv2.boundingRect(marked.view(np.uint8))
    return top, top + height, left, left + width


def around(marked: BoolMask, room: int) -> tuple[slice, slice]:
    """Return the rows and columns around marked pixels (H, W), with a margin; everything if none is marked.

    >>> around(np.pad(np.ones((2, 3), bool), 5), 1)
    (slice(4, 8, None), slice(4, 9, None))
    """
    top, bottom, left, right = box_of(marked)
    if top == bottom:
        return np.s_[:, :]
    return np.s_[max(top - room, 0) : bottom + room, max(left - room, 0) : right + room]


def extent_of(marked: BoolMask) -> int:
    """Return the longer side in pixels of the bounding box of marked pixels (H, W); 0 if there are none.

    >>> extent_of(np.pad(np.ones((2, 3), bool), 1))
    3
    """
    top, bottom, left, right = box_of(marked)
    return max(bottom - top, right - left)


def depth_of(marked: BoolMask, metric: Literal[3, 5] = 5) -> Floats:
    """Return the distance (H, W) in pixels of each marked pixel from the nearest unmarked one; 0 if unmarked.

    Pixels outside the picture count as unmarked.

    Args:
        marked: (H, W), the marked pixels.
        metric: size of OpenCV's distance mask; 3 is faster, 5 is more accurate.

    >>> depth_of(np.ones((3, 3), bool), 3).round().tolist()
    [[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 1.0, 1.0]]
    """
    padded = cv2.copyMakeBorder(marked.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    return np.asarray(cv2.distanceTransform(padded, cv2.DIST_L2, metric)[1:-1, 1:-1], np.float32)


def enclosed_by(barrier: BoolMask) -> BoolMask:
    """Return the barrier (H, W) and all pixels that it separates from the picture's edge."""
    reached = cv2.copyMakeBorder(barrier.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    cv2.floodFill(reached, None, (0, 0), 2, flags=4)
    inside: BoolMask = reached[1:-1, 1:-1] != 2
    return inside


def united(boxes: Iterable[Bounds]) -> Bounds:
    """Return the smallest box that contains one or more boxes.

    >>> united([(1, 3, 1, 4), (0, 2, 2, 9)])
    (0, 3, 1, 9)
    """
    top, bottom, left, right = zip(*boxes, strict=True)
    return min(top), max(bottom), min(left), max(right)
