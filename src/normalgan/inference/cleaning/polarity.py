"""Polarity: whether a drawing has dark lines on light paper, or light ones on dark."""

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.histogram import Histogram, median
from normalgan.inference.reading.picture import fitted, resize

__all__ = ["is_light_on_dark"]

_SIDE, _WINDOWS = 256, (3, 5, 7, 11, 17)


def is_light_on_dark(brightness: Floats) -> bool:
    """Return whether the lines of a drawing (H, W), bright as 1, are lighter than its paper.

    Most of a drawing, and its border, are paper: if both are light, the lines are dark. If not, as on a desk,
    lines are what is thin: dark ones are filled by morphological closing, light ones removed by opening. Gaps
    are wider than lines, so the windows grow until dark or light ones prevail.

    >>> chalk = np.full((64, 64), 0.1, np.float32)
    >>> chalk[32] = 0.9
    >>> is_light_on_dark(chalk), is_light_on_dark(1 - chalk)
    (True, False)
    """
    small = resize(brightness, fitted((brightness.shape[0], brightness.shape[1]), _SIDE))
    levels = Histogram(small, 0, 1)
    low, high = levels.quantile(0.005), levels.quantile(0.995)
    sides = [small[:2].ravel(), small[-2:].ravel(), small[:, :2].ravel(), small[:, -2:].ravel()]
    middle, border = (low + high) / 2, median(np.concatenate(sides))
    if min(border, levels.quantile(0.5)) > middle:
        return False
    contrast = max(high - low, 1e-3)
    for width in _WINDOWS:
        window = np.ones((width, width), np.uint8)
        darker = float(((cv2.morphologyEx(small, cv2.MORPH_BLACKHAT, window) / contrast) ** 2).sum())
        lighter = float(((cv2.morphologyEx(small, cv2.MORPH_TOPHAT, window) / contrast) ** 2).sum())
        if max(lighter, darker) > max(2 * min(lighter, darker), 0.001 * small.size):
            return lighter > darker
    return border < middle
