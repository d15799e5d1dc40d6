"""Outline mask: the object that the lines of a drawing enclose, past small gaps."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask
from normalgan.inference.cleaning.silhouette import enclosed_by
from normalgan.inference.network.framing import around, box_of
from normalgan.inference.network.line_width import line_width

__all__ = ["Outline", "fill_outline"]

_GAPS = (0.0, 0.005, 0.012, 0.018)
"""Half the widths of gaps that are closed, as shares of the span."""
_CLOSED = 0.93
"""An outline is closed once as much of the ink encloses something; the rest are whiskers."""
_WINDOW = 7.0
"""Pixels; up to as many, a window is faster than distances."""


@dataclass(frozen=True)
class Outline:
    """What the lines of a drawing enclose, to a few pixels.

    Args:
        mask: (h, w), the inside and the lines around it.
        closed: share of the ink that lies in or around the inside; low where an outline has wide gaps.
    """

    mask: BoolMask
    closed: float


def fill_outline(inked: BoolMask) -> Outline:
    """Return what lines (h, w) enclose.

    Lines are made thicker in steps, which closes wider and wider gaps, until nearly all of them enclose
    something. Areas that cannot be reached from outside are then inside, and get back the pixels that thick
    lines took from them.
    """
    if not inked.any():
        return Outline(np.zeros_like(inked), 0.0)
    top, bottom, left, right = box_of(inked)
    span = max(bottom - top, right - left)
    margin = int(max(_GAPS) * span) + 2
    lines = cv2.copyMakeBorder(inked.view(np.uint8), *(margin,) * 4, cv2.BORDER_CONSTANT, value=0) > 0
    total, reach = int(np.count_nonzero(lines)), line_width(lines) + 1.5
    inside = near = np.zeros_like(lines)
    closed = 0.0
    for gap in (share * span for share in _GAPS):
        if closed > _CLOSED:
            break
        thick = _thicker(lines, gap)
        fresh = enclosed_by(thick) & ~thick & ~inside
        if not fresh.any():
            continue
        inside = inside | (_grown(fresh, lines, gap) if gap else fresh)
        near = _thicker(inside, reach)
        closed = int(np.count_nonzero(lines & near)) / total
    if inside.any():
        # The lines at its edge belong to it, and so do eyes and stripes, whatever they are drawn with.
        inside = enclosed_by(inside | (lines & near))
    return Outline(inside[margin:-margin, margin:-margin], closed)


def _grown(seeds: BoolMask, barrier: BoolMask, reach: float) -> BoolMask:
    """Return seeds with all within ``reach`` pixels that is not behind a barrier."""
    box = around(seeds, int(reach) + 1)
    free = (~barrier[box] & _thicker(seeds[box], reach + 0.5)).astype(np.uint8)
    grown = seeds[box].astype(np.uint8)
    # Steps to the side only: the pixels of a slanted line may touch at their corners only.
    step = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    for _ in range(int(np.ceil(reach * np.sqrt(2)))):
        grown = np.minimum(cv2.dilate(grown, step), free)
    whole = np.zeros_like(seeds)
    whole[box] = grown > 0
    return whole


def _thicker(marked: BoolMask, reach: float) -> BoolMask:
    """Return what is marked (H, W) and all within ``reach`` pixels of it."""
    if reach < 1:
        return marked
    if reach < _WINDOW:
        along = np.arange(-int(reach), int(reach) + 1)
        disc = (np.hypot(along, along[:, None]) <= reach).astype(np.uint8)
        return np.asarray(cv2.dilate(marked.astype(np.uint8), disc) > 0)
    away = cv2.distanceTransform((~marked).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(away <= reach)
