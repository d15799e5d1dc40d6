"""Marked pixels, and the distance to them."""

from collections.abc import Sequence

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.rendering.lines.crossings import Line

__all__ = ["distance_to", "mark"]


def mark(lines: Sequence[Line], shape: tuple[int, ...]) -> BoolMask:
    """Return the pixels, in a picture of ``shape``, that lines belong to."""
    marks = np.zeros(shape, bool)
    for line in lines:
        marks[tuple(line.pixels.T)] = True
    return marks


def distance_to(marks: BoolMask) -> Floats:
    """Return the distance in pixels from each pixel to the nearest marked one; huge if there is none.

    Chamfer distance with a 5 × 5 mask: within 2 % of the Euclidean one at a fraction of its cost.
    """
    if not marks.any():
        return np.full(marks.shape, np.finfo(np.float32).max, np.float32)
    distance = cv2.distanceTransform((~marks).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return distance.astype(np.float32, copy=False)
