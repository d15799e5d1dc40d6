"""Edge: find an object's edge with subpixel accuracy from its outline."""

from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.network.line_width import line_width
from normalgan.inference.reading.picture import resize
from normalgan.inference.regions import around, depth_of, extent_of

_PALEST = 0.35
"""Minimum ink at the darkest place of a line."""
_LARGE = 1024
"""Maximum longer side at which regions and lines are separated; larger drawings are halved first."""
_MERGED = 1.5
"""Minimum width of the ink where two lines meet in a tip, as a multiple of the line width."""
_TIP = 0.25
"""Maximum length of a tip, as a fraction of the object's extent."""
_TOUCHING, _FINER = 1.3, 1.25
"""Maximum distance of a line's centre from the inside, in half widths, and the ratio between width bins."""
_WINDOW = 14
"""Maximum reach in pixels at which dilation is faster than a distance transform."""
_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
_SQUARE, _WIDE = np.ones((3, 3), np.uint8), np.ones((5, 5), np.uint8)


def snap(mask: BoolMask, ink: Floats, reach: float) -> Floats:
    """Return the exact coverage (H, W) of an object whose mask is accurate to a few pixels.

    Lines divide the drawing into regions, and each region is assigned to the object or the background by
    majority. Where a gap connects two regions, inside and outside meet half-way between the pixels where the
    mask is certain. The outline's ink is part of the object, so the object's edge is the outer edge of the
    ink and just as soft.

    Args:
        mask: (H, W), the object, whose edge may be off by ``reach`` pixels.
        ink: (H, W) in [0, 1], the lines.
        reach: maximum distance in pixels between the mask's edge and the outer edge of the line it follows.

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
    # The margin leaves space for a tip outside the mask.
    box = around(mask, int(_TIP * extent_of(mask)) + int(reach) + 4)
    lines = ink[box]
    darkest = cv2.dilate(lines, _WIDE)
    # In place, because large new arrays take longer than the arithmetic.
    share = np.divide(lines, np.maximum(darkest, _PALEST, out=darkest), out=darkest)
    np.minimum(share, 1, out=share)
    inked = share > 0.5
    covered[box] = _soft(_body(mask[box], lines, inked, reach), inked, share)
    return covered


def _body(mask: BoolMask, ink: Floats, inked: BoolMask, reach: float) -> BoolMask:
    """Return the object with all of its ink, from its mask and the drawing's lines.

    Args:
        mask: (H, W), the object, whose edge may be inaccurate.
        ink: (H, W) in [0, 1], the lines.
        inked: (H, W), where there is more ink than paper.
        reach: maximum error of the mask's edge in pixels.
    """
    shape = (mask.shape[0], mask.shape[1])
    if max(shape) > _LARGE:
        # Half size settles everything except the last two pixels at the edge.
        half = ((shape[0] + 1) // 2, (shape[1] + 1) // 2)
        small = resize(ink, half)
        # Here the lines only separate regions, for which their absolute ink is enough. `_finish` then follows
        # the ink relative to each line's darkest place, at full size.
        rough = _body(resize(mask.astype(np.float32), half) > 0.5, small, small > _PALEST, reach / 2)
        return _finish(resize(rough.astype(np.float32), shape) > 0.5, inked)
    inside = _divide(mask, inked, reach)
    whole = inside | _own_ink(mask, inside, inked)
    return whole | _tips(whole, inked)


def _finish(rough: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the object with its edge corrected to the ink, where the edge is off by at most two pixels."""
    lines = inked.view(np.uint8)
    grown = np.asarray(cv2.dilate(rough.view(np.uint8), _WIDE), np.uint8)
    shrunk = np.asarray(cv2.erode(rough.view(np.uint8), _WIDE), np.uint8)
    free = 1 - lines
    inner, outer = _grow(shrunk & free, (1 - grown) & free, free, 6)
    body: BoolMask = (inner > 0) | (inked & (grown > 0)) | (rough & (outer == 0))
    return body


def soft_edge(mask: BoolMask) -> Floats:
    """Return a mask as opacity (H, W) with an anti-aliased edge."""
    soft = np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 1.0), np.float32)
    soft -= 0.5
    soft *= 1.6
    soft += 0.5
    return np.clip(soft, 0, 1, out=soft)


def _divide(mask: BoolMask, inked: BoolMask, reach: float) -> BoolMask:
    """Return the pixels of the object that are not on lines."""
    free = ~inked
    count, found = cv2.connectedComponents(free.view(np.uint8), connectivity=4)
    labels = np.asarray(found, np.int32)
    # The faster metric is accurate enough, because the reach is only a tolerance.
    within, beyond = ~_near(~mask, reach, 3), ~_near(mask, reach, 3)
    size, held, sure_in, sure_out = _region_sums(labels, count, mask, within, beyond)
    # A region with certain pixels on one side of the mask's edge only lies entirely on that side.
    whole = (sure_in == 0) | (sure_out == 0)
    whole[0] = False
    inside: BoolMask = np.take(whole & (held > 0.5 * size), labels)
    mixed = free & ~np.take(whole, labels)
    return (inside | _meet(mask, mixed, within | beyond, reach)) if mixed.any() else inside


def _meet(mask: BoolMask, mixed: BoolMask, sure: BoolMask, reach: float) -> BoolMask:
    """Return the object's pixels in regions with a gap, by growing inside and outside until they meet."""
    free = mixed.astype(np.uint8)
    sure_in: NDArray[np.uint8] = (mixed & sure & mask).astype(np.uint8)
    sure_out: NDArray[np.uint8] = (mixed & sure & ~mask).astype(np.uint8)
    inner, outer = _grow(sure_in, sure_out, free, int(2 * reach) + 2)
    return np.where(outer > 0, False, (inner > 0) | (mask & mixed))


def _grow(
    inner: NDArray[np.uint8], outer: NDArray[np.uint8], free: NDArray[np.uint8], steps: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return two areas (H, W) of 0 and 1 that grow over free pixels by one pixel a step, until they meet."""
    for _ in range(steps):
        inner = np.asarray(cv2.dilate(inner, _CROSS), np.uint8) & free & (1 - outer)
        outer = np.asarray(cv2.dilate(outer, _CROSS), np.uint8) & free & (1 - inner)
    return inner, outer


def _own_ink(mask: BoolMask, inside: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the ink of an object: the lines that bound it, in their full width, and the lines inside it.

    A line is treated as discs along its centre line. A disc belongs to the object if it touches the inside,
    or if its centre is in the mask, as for a leg drawn as a single line.
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
        # The accurate metric, as for `depth`: the discs are the drawn ink itself.
        own[box] |= _near(centres[box], most, 5)
    # Discs do not cover the corners of a line.
    for _ in range(2):
        own = (cv2.dilate(own.view(np.uint8), _SQUARE) > 0) & inked
    return own


def _tips(body: BoolMask, inked: BoolMask) -> BoolMask:
    """Return the tips where two lines of an outline meet, outside the area that they enclose.

    An overshooting line has the usual width; where two lines meet, the ink is wider.

    Args:
        body: (H, W), the object without tips.
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
    """Return the coverage of each pixel: the ink's at an inked edge, otherwise an anti-aliased edge."""
    covered = soft_edge(body)
    # By one pixel only, because the inner edge of a thin line is inside.
    outside = cv2.dilate((~body).view(np.uint8), _CROSS) > 0
    line = cv2.dilate((body & inked).view(np.uint8), _WIDE) > 0
    rim = body & inked & outside
    covered[rim] = share[rim]
    # The soft edge of a line extends at most two pixels beyond its ink.
    fringe = ~body & ~inked & line
    covered[fringe] = share[fringe]
    covered[body & ~rim & line] = 1
    return covered


def _region_sums(labels: NDArray[Any], count: int, *marked: BoolMask) -> NDArray[np.intp]:
    """Return for each region the number of pixels, and of pixels marked in each of N masks, (1 + N, count).

    Args:
        labels: region of each pixel, of any shape.
        count: number of regions.
        marked: masks of the same shape.
    """
    kinds = 2 ** len(marked)
    # Bit k of a pixel's code is set if the pixel is marked in mask k.
    codes = labels * kinds
    for bit, each in enumerate(marked):
        codes += each * np.int32(2**bit)
    found = np.bincount(codes.ravel(), minlength=kinds * count).reshape(count, kinds)
    has = np.arange(kinds) >> np.arange(len(marked))[:, None] & 1
    return np.vstack([found.sum(1), has @ found.T])


def _near(marked: BoolMask, reach: float, metric: int) -> BoolMask:
    """Return the pixels (H, W) at most ``reach`` from a marked one; ``metric`` is OpenCV's mask size."""
    if reach <= _WINDOW:
        return cv2.dilate(marked.view(np.uint8), _disc(reach, metric)) > 0
    return np.asarray(cv2.distanceTransform((~marked).view(np.uint8), cv2.DIST_L2, metric) <= reach)


@lru_cache(128)
def _disc(reach: float, metric: int) -> NDArray[np.uint8]:
    """Return a disc (K, K): the pixels at most ``reach`` from the centre."""
    most = int(reach / 0.95)  # a step to the side counts as 0.955 or 1 pixel in OpenCV
    middle = np.ones((2 * most + 1, 2 * most + 1), np.uint8)
    middle[most, most] = 0
    return np.asarray(cv2.distanceTransform(middle, cv2.DIST_L2, metric) <= reach, np.uint8)
