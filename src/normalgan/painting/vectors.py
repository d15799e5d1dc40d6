"""Vectors: unit vectors of large pictures, plane by plane, in a fraction of the time of the general way."""

import cv2
import numpy as np

from normalgan.normals import Floats, strips

__all__ = ["lengths", "unit"]

_NONE = np.float32(1e-8)


def lengths(vectors: Floats) -> Floats:
    """Return the lengths (H, W) of vectors (H, W, 3), float32."""
    # Not by cv2.magnitude: its last bits depend on where in the memory the result lies.
    out = np.empty(vectors.shape[:2], np.float32)
    for strip in strips(vectors.shape):
        np.sqrt(sum(plane * plane for plane in cv2.split(vectors[strip])), out=out[strip])
    return out


def unit(vectors: Floats, front: bool = False, out: Floats | None = None) -> Floats:
    """Return unit vectors (H, W, 3) of float32 ones.

    Args:
        vectors: (H, W, 3).
        front: whether those shorter than 1e-8 are to face the viewer; else they become zero.
        out: (H, W, 3), what the result is written to, be it the vectors themselves; None is a new array.

    >>> unit(np.array([[[0, 0, 2], [0, 0, 0]]], np.float32)).tolist()
    [[[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]]
    >>> unit(np.zeros((1, 1, 3), np.float32), front=True).tolist()
    [[[0.0, 0.0, 1.0]]]
    """
    out = np.empty(vectors.shape, np.float32) if out is None else out
    for strip in strips(vectors.shape):
        planes = cv2.split(vectors[strip])
        length = np.sqrt(sum(plane * plane for plane in planes))
        there = length > _NONE
        scale = there / np.maximum(length, _NONE)
        planes = [plane * scale for plane in planes]
        if front and not there.all():
            planes[2] += ~there
        cv2.merge(planes, dst=out[strip])
    return out
