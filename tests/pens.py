"""Drawings of known shape for the tests of painting."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats

Pixels = NDArray[np.uint8]


def blob(
    shape: tuple[int, int] = (200, 300), centre: tuple[int, int] = (170, 90), radius: int = 60
) -> Floats:
    """Return a filled round shape with an ear, (H, W), 1 inside."""
    canvas = np.zeros(shape, np.uint8)
    cv2.circle(canvas, centre, radius, 1, -1, cv2.LINE_8)
    ear = np.array([[-0.9, -0.4], [-0.8, -1.3], [-0.1, -0.9]]) * radius + centre
    cv2.fillPoly(canvas, [np.rint(ear).astype(np.int32)], 1)
    return canvas.astype(np.float32)


def outline(filled: Floats, width: float = 3.0) -> Floats:
    """Return the outline of a shape as ink, (H, W), antialiased, centred on its edge."""
    inside = cv2.distanceTransform((filled > 0.5).astype(np.uint8), cv2.DIST_L2, 5)
    outside = cv2.distanceTransform((filled < 0.5).astype(np.uint8), cv2.DIST_L2, 5)
    away = np.abs(np.where(filled > 0.5, inside, outside) - 0.5)
    return np.clip(width / 2 + 0.5 - away, 0, 1).astype(np.float32)


def overlap(one: NDArray[np.generic], other: NDArray[np.generic]) -> float:
    """Return the intersection of two masks over their union."""
    a, b = np.asarray(one) > 0.5, np.asarray(other) > 0.5
    return float((a & b).sum() / (a | b).sum())
