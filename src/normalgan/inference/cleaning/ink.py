"""Ink: the lines of a drawing, and the object where the opacity of the drawing shows it."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.cleaning.reader import GREY, Reading, over_paper
from normalgan.inference.cleaning.silhouette import contour, is_silhouette
from normalgan.inference.findings import LackingError
from normalgan.inference.reading.picture import Picture

__all__ = ["Cleaned", "clean"]

_LEAST = 0.3
"""Least ink of a line."""
_JOINT, _GRAIN = (9, 0.035), 0.06
"""A line on a surface is narrower than these pixels, or than this share of the longer side; and how much its
grain differs in brightness."""
_LEAST_SEEN = 0.02
"""How much a pixel counts that the reader takes for paper, as it does most joints of a wall."""


@dataclass(frozen=True)
class Cleaned:
    """A drawing's ink.

    Args:
        ink: (H, W) in [0, 1], lines about 1 and paper 0.
        silhouette: (H, W), the object, if the drawing's opacity shows it.
    """

    ink: Floats
    silhouette: BoolMask | None


def clean(picture: Picture, reading: Reading | None, repeats: bool = False) -> Cleaned:
    """Return the ink of a drawing: a photo, a scan, pencil, chalk, coloured, painted or transparent.

    Args:
        picture: the drawing.
        reading: the reader's output for it, at any size; None if it holds only dark strokes on white.
        repeats: whether it may be a surface that goes on beyond its edges, such as bricks. The reader takes
            one for ground.

    Raises:
        LackingError: if it holds no line.
    """
    silhouette = None
    ink = 1 - picture.colour.min(-1) if reading is None else reading.ink_at(picture)
    if repeats:
        ink = _of_surface(ink, np.asarray(over_paper(picture) @ GREY, np.float32))
    if picture.alpha is not None and is_silhouette(picture, reading):
        silhouette = picture.alpha > 0.5
        ink = np.maximum(np.where(silhouette, ink, 0), contour(silhouette))
    if float(ink.max()) < _LEAST:
        raise LackingError(
            "no line is seen in it; a sketch needs lines that differ from their paper.", "no_lines"
        )
    return Cleaned(np.asarray(ink, np.float32), silhouette)


def _of_surface(ink: Floats, grey: Floats) -> Floats:
    """Return the ink (H, W) of a surface: the areas of the reader's ink, and thin lines, dark or light.

    Joints are all dark or all light: whichever the reader's ink follows, or if it has none, stand out more.
    They are found by the top-hat transform of Serra, "Image Analysis and Mathematical Morphology", 1982.

    Args:
        ink: (H, W) in [0, 1], by the reader, to which close lines are one.
        grey: (H, W), brightness.
    """
    width = max(_JOINT[0], round(_JOINT[1] * max(grey.shape)))
    window = np.ones((width, width), np.uint8)
    hats = [cv2.morphologyEx(grey, way, window) for way in (cv2.MORPH_BLACKHAT, cv2.MORPH_TOPHAT)]
    lines = np.asarray(max(hats, key=lambda hat: float((hat * (ink + _LEAST_SEEN)).sum())), np.float32)
    strongest = max(float(np.quantile(lines, 0.99)), 2 * _GRAIN)
    joints = np.clip((lines - _GRAIN) / (strongest - _GRAIN), 0, 1)
    areas = cv2.morphologyEx(np.asarray(ink, np.float32), cv2.MORPH_OPEN, window)
    return np.asarray(np.maximum(areas, joints), np.float32)
