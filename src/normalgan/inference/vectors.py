"""Vectors: fast normalisation of large vector fields."""

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.normals import strips

_NONE = np.float32(1e-8)
_SUM = np.ones((1, 3), np.float32)


def lengths(vectors: Floats) -> Floats:
    """Return the lengths (H, W) of float32 vectors (H, W, 3)."""
    # cv2.magnitude is not used, because its last bits depend on the memory alignment of the result.
    out = np.empty(vectors.shape[:2], np.float32)
    for strip in strips(vectors.shape):
        # OpenCV sums the three channels in half the time of NumPy.
        squares = cv2.transform(vectors[strip] * vectors[strip], _SUM)
        np.sqrt(squares.reshape(out[strip].shape), out=out[strip])
    return out


def unit(
    vectors: Floats, front: bool = False, out: Floats | None = None, length: Floats | None = None
) -> Floats:
    """Return float32 vectors (H, W, 3) scaled to unit length.

    Args:
        vectors: (H, W, 3).
        front: whether vectors shorter than 1e-8 are replaced by (0, 0, 1); otherwise they become zero.
        out: (H, W, 3), array for the result, which may be ``vectors``; None allocates a new array.
        length: (H, W), from `lengths`, if already computed.

    >>> unit(np.array([[[0, 0, 2], [0, 0, 0]]], np.float32)).tolist()
    [[[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]]
    >>> unit(np.zeros((1, 1, 3), np.float32), front=True).tolist()
    [[[0.0, 0.0, 1.0]]]
    """
    out = np.empty(vectors.shape, np.float32) if out is None else out
    for strip in strips(vectors.shape):
        own = lengths(vectors[strip]) if length is None else length[strip]
        there = own > _NONE
        scale = np.maximum(own, _NONE)
        np.divide(np.float32(1), scale, out=scale)
        everywhere = bool(there.all())
        if not everywhere:
            scale *= there
        # NumPy takes many times as long to broadcast over the last axis.
        np.multiply(vectors[strip], cv2.merge([scale, scale, scale]), out=out[strip])
        if front and not everywhere:
            out[strip][..., 2] += ~there
    return out
