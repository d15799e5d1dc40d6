"""Edge: find an object's edge to a fraction of a pixel from its outline at the drawing's own size."""

from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.network.line_width import line_width
from normalgan.inference.reading.picture import resize
from normalgan.inference.regions import around, depth_of, extent_of

__all__ = ["snap", "soft_edge"]

_PALEST = 0.35
"""Least ink of a line at its darkest."""
_LARGE = 1024
"""Longest side at which regions and lines are separated; larger drawings are decided at half their size."""
_MERGED = 1.5
"""Width of the ink where two lines meet in a tip, as a multiple of a line's width."""
_TIP = 0.25
"""Longest tip, as a share of what the object spans."""
_TOUCHING, _FINER = 1.3, 1.25
"""How far from the inside a line's middle may be, in halves of its width; and the step between widths."""
_WINDOW = 14
"""Reach in pixels up to which dilation is faster than a distance transform."""
_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
_SQUARE, _WIDE = np.ones((3, 3), np.uint8), np.ones((5, 5), np.uint8)


def snap(mask: BoolMask, ink: Floats, reach: float) -> Floats:
    """Return the coverage (H, W) of an object whose mask is accurate to a few pixels.

    Lines divide the drawing into regions, and each region belongs to the object or not, as most of it does.
    Where a gap joins two regions, inside and outside meet half-way between the places where the mask is sure.
    The outline's ink is part of the object, so the edge is the ink's outer edge, as soft as that.

    Args:
        mask: (H, W), the object, whose edge may be off by ``reach`` pixels.
        ink: (H, W) in [0, 1], the lines.
        reach: how far the mask's edge may be from the outer edge of the line that it follows, in pixels.

    Example:
        >>> ink = np.zeros((32, 32), np.float32)
        >>> ink[8:24, 8:24] = 1
        >>> ink[10:22, 10:22] = 0
        >>> rough = np.pad(np.ones((12, 13), bool), ((9, 11), (10, 9)))
        >>> found = snap(rough, ink, 3)
        >>> bool((found[8:24, 8:24] == 1).all()), int((found > 0.5).sum()) == 16 * 16
        (True, True)
    """
    covered = np.zeros(mask.shape, np.float32)
    if not mask.any():
        return covered
    # A tip may be as far outside of the mask.
    box = around(mask, int(_TIP * extent_of(mask)) + int(reach) + 4)
    lines = ink[box]
    darkest = cv2.dilate(lines, _WIDE)
    share = np.minimum(lines / np.maximum(darkest, _PALEST), 1)
    inked = share > 0.5
    covered[box] = _soft(_body(mask[box], lines, inked, reach), inked, share)
    return covered


def _body(mask: BoolMask, ink: Floats, inked: BoolMask, reach: float) -> BoolMask:
    """Return the object with all of its ink, from its mask and the drawing's lines.

    Args:
        mask: (H, W), the object, whose edge may be off.
        ink: (H, W) in [0, 1], the lines.
        inked: (H, W), where there is more ink than paper.
        reach: how far the mask's edge may be off, in pixels.
    """
    shape = (mask.shape[0], mask.shape[1])
    if max(shape) > _LARGE:
        # Half the size decides everything except the last pixels.
        half = ((shape[0] + 1) // 2, (shape[1] + 1) // 2)
        small = resize(ink, half)
        rough = _body(resize(mask.astype(np.float32), half) > 0.5, small, small > _PALEST, reach / 2)
        return _finish(resize(rough.astype(np.float32), shape) > 0.5, inked)
    inside = _divide(mask, inked, reach)
    whole = inside | _own_ink(mask, inside, inked)
    return whole | _tips(whole, inked)


def _finish(rough: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the object with the ink at its edge, which is off by at most two pixels."""
    lines = inked.view(np.uint8)
    grown = np.asarray(cv2.dilate(rough.view(np.uint8), _WIDE), np.uint8)
    shrunk = np.asarray(cv2.erode(rough.view(np.uint8), _WIDE), np.uint8)
    free = 1 - lines
    one, other = shrunk & free, (1 - grown) & free
    for _ in range(6):
        further = np.asarray(cv2.dilate(one, _CROSS), np.uint8) & free & (1 - other)
        other = np.asarray(cv2.dilate(other, _CROSS), np.uint8) & free & (1 - further)
        one = further
    body: BoolMask = (one > 0) | (inked & (grown > 0)) | (rough & (other == 0))
    return body


def soft_edge(mask: BoolMask) -> Floats:
    """Return a mask as opacity (H, W) with an anti-aliased edge."""
    soft = np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 1.0), np.float32)
    soft -= 0.5
    soft *= 1.6
    soft += 0.5
    return np.clip(soft, 0, 1, out=soft)


def _divide(mask: BoolMask, inked: BoolMask, reach: float) -> BoolMask:
    """Return the object's pixels between the lines."""
    free = ~inked
    count, found = cv2.connectedComponents(free.view(np.uint8), connectivity=4)
    labels = np.asarray(found, np.int32)
    # Of a region in which the mask is surely right on one side only, all is on that side.
    within, beyond = ~_near(~mask, reach, 3), ~_near(mask, reach, 3)
    size, held, core, rest = _region_sums(labels, count, mask, within, beyond)
    whole = (core == 0) | (rest == 0)
    whole[0] = False
    inside: BoolMask = np.take(whole & (held > 0.5 * size), labels)
    mixed = free & ~np.take(whole, labels)
    return inside | _meet(mask, mixed, within | beyond, reach) if mixed.any() else inside


def _meet(mask: BoolMask, mixed: BoolMask, sure: BoolMask, reach: float) -> BoolMask:
    """Return the object's pixels in regions with a gap: inside and outside grow until they meet."""
    free = mixed.astype(np.uint8)
    one: NDArray[np.uint8] = (mixed & sure & mask).astype(np.uint8)
    other: NDArray[np.uint8] = (mixed & sure & ~mask).astype(np.uint8)
    for _ in range(int(2 * reach) + 2):
        grown = np.asarray(cv2.dilate(one, _CROSS), np.uint8) & free & ~other
        other = np.asarray(cv2.dilate(other, _CROSS), np.uint8) & free & ~grown
        one = grown
    return np.where(other > 0, False, (one > 0) | (mask & mixed))


def _own_ink(mask: BoolMask, inside: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the ink of an object: the lines that bound it, each to its own width, and those in it.

    A line is treated as discs along its middle. A disc belongs to the object if it touches its inside, or if
    its middle is in the mask, as that of a leg that is a single line.
    """
    lines = inked.view(np.uint8)
    depth = cv2.distanceTransform(lines, cv2.DIST_L2, 5)
    ridge = inked & (depth >= cv2.dilate(depth, _SQUARE) - np.float32(1e-4))
    away = cv2.distanceTransform((~inside).view(np.uint8), cv2.DIST_L2, 5)
    middles = ridge & (mask | (away <= _TOUCHING * depth + 1.5))
    own = mask & inked & (away <= _TOUCHING * depth + 1.5)
    rows, columns = np.nonzero(middles)
    radii = depth[rows, columns]
    widths = np.floor(np.log(radii) / np.log(_FINER))
    for width in np.unique(widths):
        centres, alike, most = np.zeros_like(inked), widths == width, _FINER ** (float(width) + 1)
        centres[rows[alike], columns[alike]] = True
        box = around(centres, int(most) + 1)
        own[box] |= _near(centres[box], most, 5)
    # Discs leave out the corners of a line.
    for _ in range(2):
        own = (cv2.dilate(own.view(np.uint8), _SQUARE) > 0) & inked
    return own


def _tips(body: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the tips where two lines of an outline meet, beyond the area that they enclose.

    A line that shot beyond its goal is as wide as any; where two meet, their ink is wider.

    Args:
        body: (H, W), the object without its tips.
        inked: (H, W), the lines.
    """
    loose = inked & ~body
    near = cv2.dilate(body.view(np.uint8), _SQUARE) > 0
    if not (loose & near).any():
        return np.zeros_like(body)
    count, found = cv2.connectedComponents(loose.view(np.uint8), connectivity=8)
    labels = np.asarray(found, np.int32)
    width = line_width(inked)
    merged = 2 * depth_of(inked) - 1 > max(_MERGED * width, width + 1.5)
    _, wide, reached = _region_sums(labels[loose], count, merged[loose], near[loose])
    kept = (wide > 0) & (reached > 0)
    kept[0] = False
    return np.take(kept, labels)


def _soft(body: BoolMask, inked: BoolMask, share: Floats) -> Floats:
    """Return the coverage of each pixel: that of the ink, or an anti-aliased edge."""
    covered = soft_edge(body)
    outside = cv2.dilate((~body).view(np.uint8), _CROSS) > 0  # no farther: a thin line's inner edge is inside
    line = cv2.dilate((body & inked).view(np.uint8), _WIDE) > 0
    rim = body & inked & outside
    covered[rim] = share[rim]
    # Two pixels beyond its ink a soft line has ended.
    fringe = ~body & ~inked & line
    covered[fringe] = share[fringe]
    covered[body & ~rim & line] = 1
    return covered


def _region_sums(labels: NDArray[Any], count: int, *marked: BoolMask) -> NDArray[np.intp]:
    """Return the number of pixels of each region, and of those marked in each of N pictures, (1 + N, count).

    Args:
        labels: of any shape, the region of each pixel.
        count: of regions.
        marked: of the same shape.
    """
    kinds = 2 ** len(marked)
    codes = labels * kinds
    for bit, each in enumerate(marked):
        codes += each * np.int32(2**bit)
    found = np.bincount(codes.ravel(), minlength=kinds * count).reshape(count, kinds)
    has = np.arange(kinds) >> np.arange(len(marked))[:, None] & 1
    return np.vstack([found.sum(1), has @ found.T])


def _near(marked: BoolMask, reach: float, metric: int) -> BoolMask:
    """Return the pixels (H, W) at most ``reach`` from a marked one, by OpenCV's distances of a metric."""
    if reach <= _WINDOW:
        found: BoolMask = cv2.dilate(marked.view(np.uint8), _disc(reach, metric)) > 0
        return found
    return np.asarray(cv2.distanceTransform((~marked).view(np.uint8), cv2.DIST_L2, metric) <= reach)


@lru_cache(128)
def _disc(reach: float, metric: int) -> NDArray[np.uint8]:
    """Return the pixels (K, K) that are at most ``reach`` from the middle one."""
    most = int(reach / 0.95)  # OpenCV takes a step to the side for 0.955 of a pixel, or for one
    middle = np.ones((2 * most + 1, 2 * most + 1), np.uint8)
    middle[most, most] = 0
    return np.asarray(cv2.distanceTransform(middle, cv2.DIST_L2, metric) <= reach, np.uint8)
