"""Cleaning: the ink of a drawing, and the object where the opacity of the drawing shows it."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.cleaning.paper import ink_on_paper
from normalgan.inference.cleaning.polarity import is_light_on_dark
from normalgan.inference.cleaning.silhouette import contour, enclosed_by, is_silhouette, over_own_colour
from normalgan.inference.findings import LackingError
from normalgan.inference.reading.picture import Picture

__all__ = ["Cleaned", "clean", "ink_of_strokes", "without_specks"]

_GREY = np.array([0.299, 0.587, 0.114], np.float32)
_LEAST = 0.3
"""Least ink of a line."""
_BLACK, _VOIDS = 0.15, 1.05
"""The lightest black ink; and what it encloses with itself, as a multiple of itself, at least."""


@dataclass(frozen=True)
class Cleaned:
    """A drawing's ink.

    Args:
        ink: (H, W) in [0, 1], lines about 1 and paper 0.
        silhouette: (H, W), the object, if the drawing's opacity shows it.
    """

    ink: Floats
    silhouette: NDArray[np.bool_] | None


def clean(picture: Picture) -> Cleaned:
    """Return the ink of a drawing: a photo, a scan, pencil, chalk, coloured, painted or transparent.

    Raises:
        LackingError: if it holds no line.
    """
    colour, silhouette = picture.colour, None
    if picture.alpha is not None and is_silhouette(picture.alpha) and not _is_ink(colour, picture.alpha):
        silhouette = picture.alpha > 0.5
        colour = over_own_colour(colour, picture.alpha)
    elif picture.alpha is not None:
        seen = float((colour @ _GREY * picture.alpha).sum() / max(float(picture.alpha.sum()), 1e-6))
        paper = 1.0 if seen < 0.6 else 0.0  # light lines on nothing were drawn for a dark ground
        colour = colour * picture.alpha[..., None] + paper * (1 - picture.alpha[..., None])
    if is_light_on_dark(np.asarray(cv2.transform(colour, _GREY[None]), np.float32)):
        colour = 1 - colour
    ink = without_specks(ink_on_paper(colour))
    if silhouette is not None:
        ink = np.maximum(np.where(silhouette, ink, 0), contour(silhouette))
    return _with_lines(Cleaned(ink.astype(np.float32), silhouette))


def ink_of_strokes(picture: Picture) -> Cleaned:
    """Return the ink of a drawing that is nothing but dark strokes on white: all that is not white.

    Raises:
        LackingError: if it holds no line.
    """
    return _with_lines(Cleaned(np.asarray(1 - picture.colour.min(-1), np.float32), None))


def _with_lines(cleaned: Cleaned) -> Cleaned:
    if float(cleaned.ink.max()) < _LEAST:
        raise LackingError(
            "no line is seen in it; a sketch needs lines that differ from their paper.", "no_lines"
        )
    return cleaned


def _is_ink(colour: Floats, alpha: Floats) -> bool:
    """Return whether what is opaque is ink with much black: black all over, and around areas of nothing."""
    opaque = alpha > 0.5
    if float(np.quantile(colour[opaque], 0.98)) > _BLACK:
        return False
    return int(enclosed_by(opaque).sum()) > _VOIDS * int(opaque.sum())


def without_specks(ink: Floats) -> Floats:
    """Return ink (H, W) without dust: patches that span less than a 150th of all that is inked.

    A patch is a connected area of more than a tenth; what it spans is the longer side of its box.
    """
    marked = (ink > 0.1).view(np.uint8)
    # The algorithm that OpenCV takes by itself is half as fast.
    _, numbers, stats, _ = cv2.connectedComponentsWithStatsWithAlgorithm(marked, 8, cv2.CV_32S, cv2.CCL_BBDT)
    spans = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT])
    # Paler than half all over is no dot of a pen either.
    dark = np.zeros(len(spans), np.bool_)
    dark[numbers[ink > 0.5]] = True
    kept = (spans >= max(ink.shape) / 150) & dark
    kept[0] = True
    return ink if kept.all() else np.where(kept[numbers], ink, 0)
