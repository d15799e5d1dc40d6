"""Painted areas: wide dark areas of a drawing are coloured bodies and not lines."""

from functools import reduce

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.histogram import Histogram

__all__ = [
    "darkest",
    "lightest",
    "painted_areas",
    "paper_colour",
    "steps",
    "wide_and_dark",
]

_PAINTED = 0.8
"""What is wide and darker than this share of the sheet, in its darkest channel, is painted or shaded."""
_STEP = 0.12
"""How much darker, as a share of the sheet, a painted area is than what lies a few pixels beside it."""
_ALIKE = 0.12
"""Colours that differ by no more in any channel are one paint."""
_MOST = 12
"""Painted areas whose thin parts are looked for, the largest first."""


def darkest(colour: Floats) -> Floats:
    """Return the least channel of colours, (H, W); NumPy's own takes ten times as long."""
    return colour if colour.ndim == 2 else np.asarray(reduce(cv2.min, cv2.split(colour)), np.float32)


def lightest(colour: Floats) -> Floats:
    """Return the greatest channel of colours, (H, W), as `darkest` does the least."""
    return colour if colour.ndim == 2 else np.asarray(reduce(cv2.max, cv2.split(colour)), np.float32)


def paper_colour(paper: Floats) -> Floats:
    """Return the colour (C,) of the sheet, given that of the paper about each pixel, (H, W, 3) or (H, W)."""
    counted = [Histogram(np.asarray(channel, np.float32), 0, 1) for channel in cv2.split(paper)]
    level = np.array([each.quantile(0.5) for each in counted])
    lightest = np.array([each.quantile(0.95) for each in counted])
    # Where more than half is painted, the median is paint, in all channels: the sheet has one colour.
    painted = bool((level < 0.7 * lightest).any())
    return np.asarray(np.maximum(lightest if painted else level, 0.04), np.float32)


def wide_and_dark(paper: Floats, level: Floats) -> BoolMask:
    """Return where a drawing may be painted or shaded, (H, W).

    Args:
        paper: (H, W, 3), the lightest colour about each pixel; (H, W) if it is grey.
        level: (3,) or (1,), the sheet's colour.
    """
    wide: BoolMask = darkest(np.asarray(paper / level, np.float32)) < _PAINTED
    return wide


def steps(darkness: Floats) -> BoolMask:
    """Return where a picture (H, W) gets darker within a few pixels; at a shadow's edge it takes more."""
    square = np.ones((7, 7), np.uint8)
    found: BoolMask = cv2.dilate(darkness, square) - cv2.erode(darkness, square) > _STEP
    return found


def painted_areas(colour: Floats, paper: Floats, level: Floats, step: BoolMask) -> tuple[BoolMask, Floats]:
    """Return the painted areas (H, W) of a drawing, and the paper with these areas.

    The paper is estimated over a window, so a wide trunk is found as painted but narrow legs are not. Pixels
    that are connected with the trunk and have its colour belong to it.

    Args:
        colour: (H, W, 3), the drawing; (H, W) if it is grey.
        paper: of the same shape, the lightest colour about each pixel.
        level: (3,) or (1,), the sheet's colour.
        step: (H, W), where it gets darker within a few pixels.
    """
    wide = wide_and_dark(paper, level)
    if not wide.any():
        return wide, paper
    painted, paper = np.zeros_like(wide), paper.copy()
    _, labels, stats, _ = cv2.connectedComponentsWithStats(wide.astype(np.uint8), connectivity=4)
    largest = 1 + np.argsort(-stats[1:, cv2.CC_STAT_AREA], kind="stable")[:_MOST]
    for label in largest[stats[largest, cv2.CC_STAT_AREA] > 16]:
        own = labels == label
        edge = own & (cv2.erode(own.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1) == 0)
        if edge.any() and step[edge].mean() < 0.5:
            continue  # shaded
        paint = np.median(colour[own], axis=0)
        alike = (lightest(np.abs(colour - paint)) < _ALIKE) & (darkest(colour / level) < _PAINTED)
        _, parts = cv2.connectedComponents((alike | own).astype(np.uint8), connectivity=4)
        parts_of_it = parts == np.bincount(parts[own]).argmax()
        same = parts_of_it & alike  # at the window's edges the trunk's paper is too light as well
        paper[same] = np.minimum(paper[same], np.maximum(paint, colour[same]))
        painted |= parts_of_it
    return painted, paper
