"""Polarity: whether a drawing has dark lines on light paper, or light ones on dark."""

import cv2
import numpy as np

from normalgan.inference.picture import fitted, resize
from normalgan.normals import Floats

_SIDE = 256


def is_light_on_dark(brightness: Floats) -> bool:
    """Return whether the lines of a drawing (H, W), bright as 1, are lighter than its paper.

    What is thin against its surroundings is line: the third power of what a pixel differs from the median
    about it is summed. Where neither side prevails, as for a filled shape, the border is paper.

    >>> chalk = np.full((64, 64), 0.1, np.float32)
    >>> chalk[32] = 0.9
    >>> is_light_on_dark(chalk), is_light_on_dark(1 - chalk)
    (True, False)
    """
    small = resize(brightness, fitted((brightness.shape[0], brightness.shape[1]), _SIDE))
    # A median over a wide window is exact and fast on 8 bits only.
    levels = np.rint(np.clip(small, 0, 1) * 255).astype(np.uint8)
    differs = small - cv2.medianBlur(levels, 41).astype(np.float32) / 255
    lighter, darker = float((differs.clip(min=0) ** 3).sum()), float(((-differs).clip(min=0) ** 3).sum())
    if max(lighter, darker) > 2 * min(lighter, darker):
        return lighter > darker
    border = np.concatenate(
        [small[:2].ravel(), small[-2:].ravel(), small[:, :2].ravel(), small[:, -2:].ravel()]
    )
    return float(np.median(border)) < 0.5
