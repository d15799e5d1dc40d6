"""Outline mask: the object that the lines of a drawing enclose, past gaps."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.mask.edge import snap
from normalgan.inference.mask.filling import MARGIN, Filling
from normalgan.inference.network.framing import box_of
from normalgan.inference.reading.picture import fitted, resize

__all__ = ["Outline", "fill_outline", "snap_outline"]

_SIDE = 512
"""Longest side at which areas are filled, and twice the shortest; the edge comes from the whole drawing."""
_OFF, _LEAST_OFF = 2.5, 2.0
"""How far that edge may be from the ink's, in pixels of that size; and in pixels of the drawing at least."""
_FAILED = 0.5
"""Below such a share of lines that enclose something, gaps of any width are closed."""


@dataclass(frozen=True)
class Outline:
    """What the lines of a drawing enclose.

    Args:
        mask: (H, W), the inside, the lines around it, and long loose lines that hang on it.
        coverage: (H, W) in [0, 1], how much of each pixel that is; more than a half in the mask.
        closed: share of the ink that lies in or around the inside; low where an outline has wide gaps.
        guessed: whether a gap was closed that is so wide that it may have been meant.
    """

    mask: BoolMask
    coverage: Floats
    closed: float
    guessed: bool = False


def fill_outline(ink: Floats) -> Outline:
    """Return what the lines of a drawing (H, W) enclose.

    Lines are made thicker in steps, which closes wider and wider gaps, until nearly all of them enclose
    something. Wide gaps are closed only if most of the outline is open. Areas that cannot be reached from
    outside are then inside, and get back the pixels that thick lines took from them.
    """
    shape = (ink.shape[0], ink.shape[1])
    # A small drawing's lines hang together only between its pixels.
    side = min(max(*shape, _SIDE // 2), _SIDE)
    small = ink if side == max(shape) else resize(ink, fitted(shape, side))
    inked = small > 0.35
    if not inked.any():
        return Outline(np.zeros(shape, bool), np.zeros(shape, np.float32), 0.0)
    top, bottom, left, right = box_of(inked)
    span = max(bottom - top, right - left)
    margin = int(MARGIN * span) + 2
    padded = cv2.copyMakeBorder(inked.view(np.uint8), *(margin,) * 4, cv2.BORDER_CONSTANT, value=0)
    filling = Filling(padded > 0, span)
    filling.fill()
    guessed = filling.closed < _FAILED and filling.guess()
    mask = filling.mask()[margin:-margin, margin:-margin]
    if small is not ink:
        mask = resize(_smooth(mask), shape) > 0.5
    coverage = snap_outline(mask, ink)
    return Outline(coverage > 0.5, coverage, filling.closed, guessed)


def snap_outline(mask: BoolMask, ink: Floats) -> Floats:
    """Return how much of each pixel (H, W) an object covers; its mask was found at `fill_outline`'s size.

    Args:
        mask: (H, W), the object.
        ink: (H, W) in [0, 1], the lines.
    """
    return snap(mask, ink, max(_OFF * max(ink.shape) / _SIDE, _LEAST_OFF))


def _smooth(mask: BoolMask) -> Floats:
    return np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.8), np.float32)
