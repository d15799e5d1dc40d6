"""Regions: sums over the connected regions of a picture."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["region_sums"]


def region_sums(
    labels: NDArray[Any], count: int, marked: NDArray[np.bool_] | None = None
) -> NDArray[np.intp]:
    """Return how many pixels each region has, (count,), or how many marked ones.

    Args:
        labels: (H, W), the number of each pixel's region, from 0.
        count: of the regions.
        marked: (H, W), the pixels that count; None counts all.

    >>> region_sums(np.array([[0, 1], [1, 1]], np.int32), 3, np.array([[True, True], [False, True]])).tolist()
    [1, 2, 0]
    """
    return np.bincount(labels.ravel() if marked is None else labels[marked], minlength=count)
