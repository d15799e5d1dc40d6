"""Patches: the connected parts of a drawing, numbered."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask

__all__ = ["patches"]

_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))


def patches(marked: BoolMask) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """Return the number of each pixel's patch, (H, W), and how wide and high each patch is, (N, 2).

    Pixels that touch at a corner are connected. Unmarked pixels have number 0, whose size is 0. OpenCV
    measures patches too, but that takes it many times as long as numbering them. scipy.ndimage is fast, but
    importing it takes longer than predicting most drawings.

    >>> patches(np.array([[1, 0, 1], [0, 1, 0], [0, 0, 0], [1, 1, 1]], bool))[1].tolist()
    [[0, 0], [3, 2], [3, 1]]
    """
    count, found = cv2.connectedComponents(marked.view(np.uint8), connectivity=8)
    numbers = np.asarray(found, np.int32)
    # Only what lies at a patch's edge can be its first or last pixel: of wide patches that is little.
    inner = cv2.erode(marked.view(np.uint8), _CROSS, borderType=cv2.BORDER_CONSTANT, borderValue=0) > 0
    places = np.flatnonzero(marked & ~inner)
    owners = numbers.ravel()[places]
    rows, columns = np.divmod(places, numbers.shape[1])
    sizes = [_extents(owners, along, count) for along in (columns, rows)]
    return numbers, np.stack(sizes, axis=1)


def _extents(owners: NDArray[np.int32], along: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Return from where to where each patch goes in one direction, in pixels, (N,).

    Args:
        owners: the number of each pixel's patch.
        along: where each pixel is in that direction.
        count: of patches, number 0 included, which has no pixels here.
    """
    first, last = np.full(count, np.iinfo(np.intp).max), np.full(count, -1)
    np.minimum.at(first, owners, along)
    np.maximum.at(last, owners, along)
    extents: NDArray[np.intp] = last - first + 1
    extents[0] = 0
    return extents
