"""Vectors: unit vectors of large pictures, plane by plane, in a fraction of the time of the general way."""

import cv2
import numpy as np

from normalgan.normals import Floats

__all__ = ["lengths", "unit"]

_NONE = np.float32(1e-8)


def lengths(vectors: Floats) -> Floats:
    """Return the lengths (H, W) of vectors (H, W, 3), float32."""
    # Not by cv2.magnitude: its last bits depend on where in the memory the result lies.
    total = sum(plane * plane for plane in cv2.split(vectors))
    return np.asarray(np.sqrt(total), np.float32)


def unit(vectors: Floats, front: bool = False) -> Floats:
    """Return unit vectors (H, W, 3) of float32 ones.

    Args:
        vectors: (H, W, 3).
        front: whether those shorter than 1e-8 are to face the viewer; else they become zero.

    >>> unit(np.array([[[0, 0, 2], [0, 0, 0]]], np.float32)).tolist()
    [[[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]]
    >>> unit(np.zeros((1, 1, 3), np.float32), front=True).tolist()
    [[[0.0, 0.0, 1.0]]]
    """
    planes = cv2.split(vectors)
    length = np.sqrt(sum(plane * plane for plane in planes))
    there = length > _NONE
    scale = there / np.maximum(length, _NONE)
    planes = [plane * scale for plane in planes]
    if front and not there.all():
        planes[2] += ~there
    return np.asarray(cv2.merge(planes), np.float32)
