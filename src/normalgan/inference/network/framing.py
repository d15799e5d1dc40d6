"""Framing: crop a drawing to the model's square input, and map predictions back."""

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.medians import median
from normalgan.inference.regions import Bounds, box_of
from normalgan.normals import normalize


@dataclass(frozen=True)
class Frame:
    """The square of a drawing that is the model's input.

    Args:
        shape: (H, W) of the drawing.
        left: x of the square's left edge in pixels of the drawing; may be negative.
        top: y of the square's top edge in pixels of the drawing; may be negative.
        side: side of the square in pixels of the drawing.
        size: side of the square in pixels of the model.
    """

    shape: tuple[int, ...]
    left: float
    top: float
    side: float
    size: int

    @classmethod
    def around(cls, ink: Floats, size: int, margin: float = 0.06) -> Self:
        """Return the frame around the lines of a drawing, with the same margin as in training.

        Args:
            ink: (H, W), the drawing.
            size: side of the model's input in pixels.
            margin: margin at each side, as a fraction of the frame.
        """
        return cls.about(bounds_of(ink), ink.shape, size, margin)

    @classmethod
    def about(cls, bounds: Bounds, shape: tuple[int, ...], size: int, margin: float = 0.06) -> Self:
        """Return the frame around a box of a drawing (H, W); see `around`."""
        top, bottom, left, right = bounds
        side = max(bottom - top, right - left) / (1 - 2 * margin)
        return cls(shape, (left + right - side) / 2, (top + bottom - side) / 2, side, size)

    def cut(self, ink: Floats) -> Floats:
        """Return the model's input for a drawing (H, W): ink (size, size) in [0, 1]."""
        shown = self.shrink(ink)
        return np.asarray(np.minimum(shown / _darkness(shown), 1), np.float32)

    def marked(self, ink: Floats) -> NDArray[np.bool_]:
        """Return the pixels (size, size) where `cut` returns more than 0.5."""
        shown = self.shrink(ink)
        return np.asarray(shown > 0.5 * _darkness(shown))

    def shrink(self, picture: Floats) -> Floats:
        """Return the frame's part of a picture (H, W) resized to (size, size), padded with zeros."""
        # Area averaging keeps thin lines, but only works on whole pixels, so the square is cropped first.
        side = round(self.side)
        left, top = round(self.left), round(self.top)
        h, w = self.shape
        x0, y0, x1, y1 = max(left, 0), max(top, 0), min(left + side, w), min(top + side, h)
        square = picture[y0:y1, x0:x1]
        if square.shape != (side, side):
            square = np.zeros((side, side), np.float32)
            square[y0 - top : y1 - top, x0 - left : x1 - left] = picture[y0:y1, x0:x1]
        method = cv2.INTER_AREA if side > self.size else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(square, (self.size, self.size), interpolation=method), np.float32)

    def cut_points(self, points: NDArray[np.floating], normals: Floats) -> Floats:
        """Return the model's hints (4, size, size): unit normals, averaged within each pixel, and their mask.

        Args:
            points: (K, 2), x right and y down in pixels of the drawing; the first pixel's centre is at 0.5.
            normals: (K, 3), unit normals.
        """
        corner = np.array([round(self.left), round(self.top)])
        x, y = np.floor((points - corner) * self.size / round(self.side)).astype(int).T
        inside = (x >= 0) & (x < self.size) & (y >= 0) & (y < self.size)
        total = np.zeros((self.size, self.size, 3), np.float32)
        np.add.at(total, (y[inside], x[inside]), normals[inside])
        unit = normalize(total)
        hinted = (np.abs(unit).sum(-1, keepdims=True) > 0).astype(np.float32)
        return np.concatenate([unit, hinted], axis=-1).transpose(2, 0, 1)

    def restore(self, predicted: Floats) -> Floats:
        """Return a prediction (size, size, C) mapped back to the drawing (H, W, C)."""
        scale = round(self.side) / self.size
        # This maps pixel centres of the model to pixel centres of the drawing.
        x0, y0 = round(self.left) + (scale - 1) / 2, round(self.top) + (scale - 1) / 2
        placed = np.array([[scale, 0, x0], [0, scale, y0]], np.float64)
        h, w = self.shape
        return np.asarray(cv2.warpAffine(predicted, placed, (w, h), flags=cv2.INTER_LINEAR), np.float32)


def _darkness(shown: Floats) -> float:
    """Return the median ink of the lines of a shrunken drawing; 1 if there are none.

    Averaging makes thin lines pale, but lines in training samples are fully dark. Dividing by the median
    restores the darker half of the lines.
    """
    lines = shown[shown > 0.1]
    return max(median(lines), 0.1) if lines.size else 1.0


def bounds_of(ink: Floats) -> Bounds:
    """Return the bounding box of the lines of a drawing (H, W) that has lines.

    >>> bounds_of(np.pad(np.ones((2, 3), np.float32), 1))
    (1, 3, 1, 4)
    """
    return box_of(ink > 0.1)
