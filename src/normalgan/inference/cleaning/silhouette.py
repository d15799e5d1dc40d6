"""Silhouette: whether a drawing's transparency shows the object's outline or only its ink."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.cleaning.reader import Reading, read, reduced
from normalgan.inference.reading.picture import Picture
from normalgan.inference.regions import around, depth_of, extent_of

__all__ = ["contour", "enclosed_by", "is_silhouette"]

_SHEET = 0.995
"""Share of a picture from which what is opaque is the sheet: one with rounded corners or a torn edge."""
_SURE = 0.05
"""How much larger the share of ink must be to be one of lines: that of a black shape is 1 or nearly so."""


def is_silhouette(picture: Picture, reading: Reading | None = None) -> bool:
    """Return whether what is opaque is an object and not just its lines, by the reader.

    If it is an object, nearly all of the object is opaque, and part of it is ink. If it is lines, nearly all
    of it is ink, and part of the object is opaque. This is right for 94 in 100 of 418 rendered pictures,
    sheets and small figures.

    Args:
        picture: the drawing.
        reading: of the drawing; None asks the reader.
    """
    if picture.alpha is None:
        return False
    opaque = picture.alpha > 0.5
    if not opaque.any() or opaque.mean() > _SHEET:
        return False
    extent = extent_of(opaque)
    if reading is None or extent < max(opaque.shape) / 2:
        # The reader sees little of what is small on a page.
        box = around(opaque, extent // 8 + 2)
        picture = Picture(np.ascontiguousarray(picture.colour[box]), np.ascontiguousarray(picture.alpha[box]))
        reading = read(picture)
    assert picture.alpha is not None
    alpha = reduced(picture.alpha, (reading.ink.shape[0], reading.ink.shape[1]))
    present = reading.presence > 0.5
    inked = float((reading.ink * alpha).sum() / alpha.sum())
    covered = float((present * alpha).sum() / max(int(present.sum()), 1))
    return inked <= covered + _SURE


def enclosed_by(barrier: BoolMask) -> BoolMask:
    """Return the barrier (H, W) and all that cannot be reached past it from the picture's edge."""
    reached = cv2.copyMakeBorder(barrier.view(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    cv2.floodFill(reached, None, (0, 0), 2, flags=4)
    inside: BoolMask = reached[1:-1, 1:-1] != 2
    return inside


def contour(silhouette: BoolMask) -> Floats:
    """Return a line just inside a silhouette (H, W), about a 250th of its extent wide, ink 1."""
    width = max(extent_of(silhouette) / 250, 1.5)
    return np.where(silhouette, np.clip(width + 0.5 - depth_of(silhouette), 0, 1), 0).astype(np.float32)
