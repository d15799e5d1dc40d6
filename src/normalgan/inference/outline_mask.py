"""Outline mask: the object that the lines of a drawing enclose, past small gaps."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.inference.line_width import line_width
from normalgan.inference.picture import fitted, resize
from normalgan.inference.silhouette import enclosed_by
from normalgan.normals import Floats

_SIDE = 512
"""Longest side at which areas are filled, and twice the shortest."""
GAPS = (0.0, 0.005, 0.012, 0.022, 0.035)
"""Half the widths of the gaps that are closed, as shares of what the drawing spans."""
_CLOSED = 0.93
"""An outline is closed once as much of the ink encloses something; the rest are whiskers."""
Mark = NDArray[np.bool_]


@dataclass(frozen=True)
class Outline:
    """What the lines of a drawing enclose.

    Args:
        mask: (H, W), the inside and the lines around it, but not loose ones.
        closed: share of the ink that lies in or around the inside; low where an outline has wide gaps.
    """

    mask: Mark
    closed: float


def fill_outline(ink: Floats) -> Outline:
    """Return what the lines of a drawing (H, W) enclose.

    Lines are made thicker step by step, so that gaps of more and more width close, until nearly all lines
    enclose something. What cannot be reached from outside then is inside, and is given back what the thick
    lines took from it. So a narrow opening between two legs, which has no room behind it, is not filled.
    """
    shape = (ink.shape[0], ink.shape[1])
    # A small drawing's lines hang together only between its pixels.
    side = min(max(*shape, _SIDE // 2), _SIDE)
    small = ink if side == max(shape) else resize(ink, fitted(shape, side))
    inked = small > 0.35
    if not inked.any():
        return Outline(np.zeros(shape, bool), 0.0)
    rows, columns = np.flatnonzero(inked.any(1)), np.flatnonzero(inked.any(0))
    span = max(np.ptp(rows), np.ptp(columns)) + 1
    margin = int(max(GAPS) * span) + 2
    inked = np.pad(inked, margin)
    away, near = _distance(inked), line_width(inked) + 1.5
    inside, closed = np.zeros_like(inked), 0.0
    for gap in GAPS:
        thick = away <= gap * span
        enclosed = enclosed_by(thick) & ~thick
        if enclosed.any():
            inside |= _grown(enclosed, inked, gap * span) if gap else enclosed
            rim = inked & (_distance(inside) <= near)
            closed = float(rim.sum() / inked.sum())
        if closed > _CLOSED:
            break
    if inside.any():
        # The lines at its edge belong to it, and so do eyes and stripes, whatever they are drawn with.
        inside = enclosed_by(inside | rim)
    inside = inside[margin:-margin, margin:-margin]
    return Outline(inside if small is ink else resize(_smooth(inside), shape) > 0.5, closed)


def _grown(seeds: Mark, barrier: Mark, reach: float) -> Mark:
    """Return seeds with all within ``reach`` pixels that is not behind a barrier."""
    # Steps to the side only: a slanted line may hang together by its pixels' corners.
    step = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    free = (~barrier & (_distance(seeds) <= reach + 0.5)).astype(np.uint8)
    grown = seeds.astype(np.uint8)
    for _ in range(int(np.ceil(reach * np.sqrt(2)))):
        grown = np.minimum(cv2.dilate(grown, step), free)
    return np.asarray(grown > 0)


def _distance(inked: Mark) -> Floats:
    away = cv2.distanceTransform((~inked).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(away, np.float32)


def _smooth(mask: Mark) -> Floats:
    return np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.8), np.float32)
