"""Outline mask: the object that lines with gaps enclose."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask
from normalgan.inference.mask.filling import MARGIN, Filling
from normalgan.inference.network.framing import box_of

__all__ = ["Outline", "fill_outline"]

_FAILED = 0.5
"""Below such a share of lines that enclose something, gaps of any width are closed."""


@dataclass(frozen=True)
class Outline:
    """The area that the lines of a drawing enclose, accurate to a few pixels.

    Args:
        mask: (h, w), the inside and the lines around it.
        closed: share of the ink that lies in or around the inside; low where an outline has wide gaps.
        guessed: whether a gap was closed that may be intended.
    """

    mask: BoolMask
    closed: float
    guessed: bool = False


def fill_outline(inked: BoolMask) -> Outline:
    """Return the area that lines (h, w) enclose.

    Lines are made thicker in steps, which closes wider and wider gaps, until nearly all of them enclose
    something. Wide gaps are closed only if most of the outline is open. Areas that cannot be reached from
    outside are then inside, and get back the pixels that thick lines took from them.
    """
    if not inked.any():
        return Outline(np.zeros_like(inked), 0.0)
    top, bottom, left, right = box_of(inked)
    span = max(bottom - top, right - left)
    margin = int(MARGIN * span) + 2
    padded = cv2.copyMakeBorder(inked.view(np.uint8), *(margin,) * 4, cv2.BORDER_CONSTANT, value=0)
    filling = Filling(padded > 0, span)
    filling.fill()
    guessed = filling.closed < _FAILED and filling.guess()
    return Outline(filling.mask()[margin:-margin, margin:-margin], filling.closed, guessed)
