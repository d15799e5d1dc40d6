"""Extract the ink of a drawing, and the object's silhouette where the opacity shows it."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.cleaning.reader import GREY, Reading, over_paper
from normalgan.inference.cleaning.silhouette import is_silhouette, opaque_part, outlined
from normalgan.inference.findings import LackingError
from normalgan.inference.reading.picture import Picture

_LEAST = 0.3
"""Minimum ink of a pixel on a line."""
_JOINT = 9, 0.035
"""Greatest width of a joint in pixels and as a fraction of the longer side; the larger one applies."""
_GRAIN = 0.06
"""Brightness variation of a surface's grain."""
_LEAST_SEEN = 0.02
"""Weight of a pixel that the reader takes for paper, as it does for most joints of a wall."""


@dataclass(frozen=True)
class Cleaned:
    """The ink of a drawing, and its silhouette if the opacity shows one.

    Args:
        ink: (H, W) in [0, 1], close to 1 on lines and 0 on paper.
        silhouette: (H, W), mask of the object, or None if the opacity does not show the object.
    """

    ink: Floats
    silhouette: BoolMask | None


def clean(
    picture: Picture, reading: Reading | None, repeats: bool = False, drawn_pixel: float = 1.0
) -> Cleaned:
    """Return the ink of a drawing in any medium: photo, scan, pencil, chalk, paint or transparent PNG.

    Args:
        picture: the drawing.
        reading: the reader's output for the drawing, at any size; None if the drawing is dark strokes on
            white.
        repeats: whether the drawing may be a surface that continues past its edges, such as bricks. The
            reader takes such a surface for background.
        drawn_pixel: side of the original drawing's pixels in pixels of ``picture``.

    Raises:
        LackingError: if the drawing has no lines.
    """
    silhouette = None
    ink = picture.darkness() if reading is None else reading.ink_at(picture)
    if repeats:
        ink = _of_surface(ink, np.asarray(over_paper(picture) @ GREY, np.float32))
    if picture.alpha is not None and is_silhouette(picture, reading, drawn_pixel):
        silhouette = opaque_part(picture.alpha)
        ink = outlined(ink, silhouette, drawn_pixel)
    if float(ink.max()) < _LEAST:
        raise LackingError(
            "no lines were found in it; a sketch needs lines that stand out from the paper.", "no_lines"
        )
    return Cleaned(np.asarray(ink, np.float32), silhouette)


def _of_surface(ink: Floats, grey: Floats) -> Floats:
    """Return the ink (H, W) of a surface: the solid areas of the reader's ink, plus thin joints.

    Joints are either all dark or all light. The polarity that agrees with the reader's ink is used; without
    ink, the one with more contrast. Joints are found with the top-hat transform (Serra, "Image Analysis and
    Mathematical Morphology", 1982).

    Args:
        ink: (H, W) in [0, 1], the reader's ink, in which lines that are close together merge.
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
