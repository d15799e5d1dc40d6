"""Extension: fill normals where the model predicted none, smoothly from those around."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.vectors import unit

__all__ = ["extend"]

_SWEEPS = 6
_MEAN = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], np.float32) / 4


def extend(normals: Floats, known: NDArray[np.bool_], needed: NDArray[np.bool_]) -> Floats:
    """Return unit normals everywhere, (H, W, 3): those known, and a near harmonic extension of them.

    Unknown pixels are filled with averages of known ones at coarser and coarser scales (push and pull;
    Gortler et al. 1996, "The Lumigraph", 3.3). At each scale, a few sweeps of the discrete Laplace equation,
    with the known normals as boundary values, smooth the steps of the coarser scale.

    Args:
        normals: (H, W, 3), unit where known.
        known: (H, W), where normals are known; True for at least one pixel.
        needed: (H, W), where the result is used; if all of it is known, the sweeps are left out.
    """
    if known.all():
        return normals
    sweeps = _SWEEPS if (needed & ~known).any() else 0
    # Opposite neighbours cancel at a point; there the surface faces the viewer.
    vectors = unit(_pushed_and_pulled(normals, known, sweeps), front=True)
    return np.asarray(cv2.copyTo(normals, known.view(np.uint8), vectors), np.float32)


def _pushed_and_pulled(values: Floats, known: NDArray[np.bool_], sweeps: int) -> Floats:
    """Return values (H, W, 3) extended from where they are known; they matter only where they are not."""
    mask = known.view(np.uint8)
    whole = cv2.cvtColor(values, cv2.COLOR_BGR2BGRA)  # the fourth value is 1
    levels = [np.asarray(cv2.copyTo(whole, mask, np.zeros_like(whole)), np.float32)]
    while max(levels[-1].shape[:2]) > 1:
        h, w = levels[-1].shape[:2]
        half = cv2.resize(levels[-1], ((w + 1) // 2, (h + 1) // 2), interpolation=cv2.INTER_AREA)
        levels.append(np.asarray(half.reshape((h + 1) // 2, (w + 1) // 2, 4), np.float32))
    # At the finest scale a pixel is known or not: it is copied, where coarser ones are known in part.
    filled = cv2.resize(_settled(levels[1:], sweeps), known.shape[::-1], interpolation=cv2.INTER_LINEAR)
    for _ in range(sweeps):
        filled = cv2.copyTo(values, mask, filled)
        filled = cv2.filter2D(filled, -1, _MEAN, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(filled, np.float32)


def _settled(levels: list[Floats], sweeps: int) -> Floats:
    """Return values (h, w, 3) at the first of several scales, (h, w, 4), that halve down to one pixel.

    A pixel's fourth value says how much of it is known, and its others are as much of a value.
    """
    coarse = np.asarray(levels[-1][..., :3] / np.maximum(levels[-1][..., 3:], 1e-12), np.float32)
    for level in reversed(levels[:-1]):
        h, w = level.shape[:2]
        filled = cv2.resize(coarse, (w, h), interpolation=cv2.INTER_LINEAR).reshape(h, w, 3)
        *own, weight = cv2.split(level)
        share = np.minimum(weight, 1) / np.maximum(weight, 1e-12)
        free = 1 - np.minimum(weight, 1)
        # Three planes alike: NumPy takes many times as long to stretch one over the last axis.
        kept = np.asarray(cv2.merge([plane * share for plane in own]), np.float32)
        moving = np.asarray(cv2.merge([free, free, free]), np.float32)
        coarse = kept + moving * np.asarray(filled, np.float32)
        for _ in range(sweeps):
            mean = cv2.filter2D(coarse, -1, _MEAN, borderType=cv2.BORDER_REPLICATE)
            coarse = np.asarray(mean.reshape(h, w, 3), np.float32)
            coarse *= moving
            coarse += kept
    return coarse
