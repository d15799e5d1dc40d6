"""Limbs: legs and tails that are drawn as a single line, which encloses nothing."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask
from normalgan.inference.cleaning.patches import patches

__all__ = ["limbs"]

_SHORTEST, _APART = 0.12, 0.03
"""How long they are, and how far from the object they may begin, as shares of what the drawing spans."""
_THINNEST = 2.5
"""Pixels; thinner ones are made thicker."""


def limbs(loose: BoolMask, body: BoolMask, span: int, width: float) -> BoolMask:
    """Return the loose lines that belong to an object, (H, W), some three pixels wide at least.

    They begin at it and are long; what is short shot beyond its goal, and what lies elsewhere is dust,
    a signature or the ground.

    Args:
        loose: (H, W), the lines that lie outside the object.
        body: (H, W), the object.
        span: longer side of the drawing in pixels.
        width: of most lines in pixels.
    """
    numbers, sizes = patches(loose)
    long = np.hypot(sizes[:, 0], sizes[:, 1]) >= _SHORTEST * span
    if not long.any():
        return np.zeros_like(loose)
    reach = 2 * max(round(_APART * span), 1) + 1
    around = cv2.dilate(body.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach)))
    begins = np.zeros(len(sizes), bool)
    begins[numbers[around > 0]] = True
    found: BoolMask = (long & begins)[numbers]
    # A thinner one would be lost when the mask is brought to another size.
    return found if width >= _THINNEST else cv2.dilate(found.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
