"""From marked pixels to ink: dropping specks, giving width, averaging down."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.rendering.maps import Floats, Maps

Mark = NDArray[np.bool_]


def grow(seed: Mark, allowed: Mark, length: float) -> Mark:
    """Return the connected strokes of ``allowed`` that touch ``seed`` and span at least ``length`` pixels.

    Strokes connect through corners (8 neighbours). What a stroke spans is the longer side of its
    bounding box, so that a blot counts less than a line of as many pixels.

    >>> allowed = np.array([[1, 1, 1, 0, 1, 0, 1, 1, 1]], bool)
    >>> seed = np.array([[0, 1, 0, 0, 1, 0, 0, 0, 0]], bool)
    >>> grow(seed, allowed, 2).astype(int)
    array([[1, 1, 1, 0, 0, 0, 0, 0, 0]])
    """
    _, labels, stats, _ = cv2.connectedComponentsWithStats(allowed.astype(np.uint8), connectivity=8)
    spans = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT])
    keep = np.zeros(len(stats), bool)
    keep[labels[seed & allowed]] = True
    keep &= spans >= length
    keep[0] = False
    grown: Mark = keep[labels]
    return grown


def distance_to(strokes: Mark) -> Floats:
    """Return the distance in pixels from each pixel to the nearest marked one; huge if there is none.

    Chamfer distance with a 5 × 5 mask: within 2 % of the Euclidean one at a fraction of its cost.
    """
    if not strokes.any():
        return np.full(strokes.shape, np.finfo(np.float32).max, np.float32)
    distance = cv2.distanceTransform((~strokes).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return distance.astype(np.float32, copy=False)


def ink(distance: Floats, width: float) -> Floats:
    """Return the coverage in [0, 1] by lines ``width`` pixels wide, given the distance to their pixels."""
    # A line thinner than a pixel covers no pixel wholly.
    covered: Floats = np.clip(width / 2 + 0.5 - distance, 0, min(width, 1))
    return covered


def without_doubles(strokes: Mark, distance: Floats, reach: float) -> Mark:
    """Return the strokes without those that on average keep within ``reach`` pixels of a contour.

    Beside a contour they would double it and say nothing more. A stroke that runs into one stays.

    Args:
        strokes: (H, W) marked pixels.
        distance: (H, W) pixels to the nearest contour.
        reach: pixels.
    """
    count, labels = cv2.connectedComponents(strokes.astype(np.uint8), connectivity=8)
    own = labels[strokes]
    size = np.bincount(own, minlength=count)
    mean = np.bincount(own, weights=distance[strokes], minlength=count) / np.maximum(size, 1)
    kept: Mark = (mean > reach)[labels] & strokes
    return kept


def object_window(mask: Mark, margin: int, multiple: int) -> tuple[slice, slice]:
    """Return the rows and columns of the object with ``margin`` pixels around, in whole ``multiple``s.

    Cropping is what makes drawing affordable: an animal fills a fraction of its frame. The mask must
    have a pixel set and sides divisible by ``multiple``.
    """
    window = []
    for axis in (1, 0):
        filled = np.flatnonzero(mask.any(axis))
        start = max(filled[0] - margin, 0) // multiple * multiple
        stop = min(-(-(filled[-1] + 1 + margin) // multiple) * multiple, mask.shape[1 - axis])
        window.append(slice(int(start), int(stop)))
    return window[0], window[1]


def crop(maps: Maps, window: tuple[slice, slice]) -> Maps:
    """Return the part of ``maps`` within ``window``."""
    return Maps(maps.normal[window], maps.depth[window], maps.mask[window])


def average_down(fine: Floats, window: tuple[slice, slice], factor: int, size: int) -> Floats:
    """Return ``fine``, the part ``window`` of a picture, averaged over squares and set into blank paper.

    Args:
        fine: the ink in the window, whose borders are multiples of ``factor``.
        window: rows and columns in the fine picture.
        factor: side of a square.
        size: side of the sketch returned.
    """
    paper = np.zeros((size, size), np.float32)
    rows, columns = (slice(part.start // factor, part.stop // factor) for part in window)
    shape = paper[rows, columns].shape
    paper[rows, columns] = cv2.resize(fine, shape[::-1], interpolation=cv2.INTER_AREA)
    return np.clip(paper, 0, 1)
