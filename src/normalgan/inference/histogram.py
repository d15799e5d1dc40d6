"""Histogram: medians and percentiles of a picture, by counting levels."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.normals import strips

__all__ = ["Histogram", "median", "ranked"]

_BINS = 4097
"""Odd, so that the middle of the range is one of them."""


class Histogram:
    """How often each value occurs in a picture, to a 4096th of the range.

    Sorting the pixels for each percentile would take longer than everything else.

    Args:
        values: (H, W), float32.
        low: values below it count as this one.
        high: values above it count as this one.

    Example:
        >>> levels = Histogram(np.arange(101, dtype=np.float32)[None] / 100, 0, 1)
        >>> round(levels.quantile(0.5), 2), round(levels.quantile(0.5, above=0.8), 2)
        (0.5, 0.9)
    """

    def __init__(self, values: Floats, low: float, high: float) -> None:
        self._low, self._step = low, (high - low) / (_BINS - 1)
        # Of whole numbers it counts many times as fast as of floats.
        whole = np.empty(values.shape, np.uint16)
        for rows in strips(values.shape):
            # The middle of the first bin is the least value: half a step is added, and the rest cut off.
            places = values[rows] * np.float32(1 / self._step)
            places += np.float32(0.5 - low / self._step)
            whole[rows] = np.clip(places, 0, _BINS - 1, out=places)
        self._counts = cv2.calcHist([whole], [0], None, [_BINS], [0, _BINS]).ravel().astype(np.int64)
        self._sums = np.cumsum(self._counts)

    def quantile(self, share: float, above: float = -np.inf, below: float = np.inf) -> float:
        """Return what ``share`` of the values between two bounds do not exceed; NaN if there are none."""
        first, last = self._bin(above), self._bin(below)
        before = int(self._sums[first] - self._counts[first])
        if int(self._sums[last]) <= before:
            return float("nan")
        return self._low + self._step * (first + _rank(self._sums[first : last + 1], share, before))

    def spread(self, centre: float, below: float) -> float:
        """Return the median distance from ``centre`` of the values below a bound."""
        counts, middle = self._counts[: self._bin(below) + 1], self._bin(centre)
        right = counts[middle:]
        left = counts[:middle][::-1]
        both = np.zeros(max(len(right), len(left) + 1), np.int64)
        both[: len(right)] += right
        both[1 : len(left) + 1] += left
        return self._step * _rank(np.cumsum(both), 0.5)

    def count(self, above: float) -> int:
        """Return how many values exceed a bound."""
        return int(self._sums[-1] - self._sums[self._bin(above)])

    def _bin(self, value: float) -> int:
        return round(min(max((value - self._low) / self._step, 0), _BINS - 1))


def _rank(sums: NDArray[np.int64], share: float, before: int = 0) -> int:
    """Return the first bin up to which ``share`` of all are counted.

    Args:
        sums: how many are counted up to each bin.
        share: share of them.
        before: how many of these do not belong to them.
    """
    wanted = max(math.ceil(share * (int(sums[-1]) - before)), 1)
    return int(np.searchsorted(sums, before + wanted))


def median(values: Floats) -> float:
    """Return the median of values (N,), one at least: `numpy.median` takes ten times as long.

    >>> median(np.array([3, 1, 2, 5], np.float32))
    2.5
    """
    half = len(values) // 2
    parted = np.partition(values, half)
    return float(parted[half] if len(values) % 2 else (parted[:half].max() + parted[half]) / 2)


def ranked(values: Floats, share: float) -> float:
    """Return the value that ``share`` of values (N,), one at least, do not exceed, as `median` finds it.

    >>> ranked(np.array([3, 1, 2, 5], np.float32), 0.75)
    3.0
    """
    place = int(share * (len(values) - 1))
    return float(np.partition(values, place)[place])
