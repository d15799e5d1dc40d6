"""Extension: fill missing normals smoothly from the normals around them."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.vectors import unit

_SWEEPS = 6
_MEAN = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], np.float32) / 4


def extend(normals: Floats, known: NDArray[np.bool_], needed: NDArray[np.bool_]) -> Floats:
    """Return normals (H, W, 3) with the unknown ones filled by a nearly harmonic extension.

    Unknown pixels are filled with averages of known ones at successively coarser scales (push-pull; Gortler
    et al. 1996, "The Lumigraph", 3.3). At each scale, a few sweeps of the discrete Laplace equation, with the
    known normals as boundary values, smooth the steps of the coarser scale.

    Args:
        normals: (H, W, 3), unit where known.
        known: (H, W), mask of the known normals; at least one pixel is True.
        needed: (H, W), mask of the pixels that are used; if all of them are known, the sweeps are skipped.
    """
    if known.all():
        return normals
    sweeps = _SWEEPS if (needed & ~known).any() else 0
    # Where opposite neighbours cancel, the normal faces the viewer.
    vectors = unit(_pushed_and_pulled(normals, known, sweeps), front=True)
    return np.asarray(cv2.copyTo(normals, known.view(np.uint8), vectors), np.float32)


def _pushed_and_pulled(values: Floats, known: NDArray[np.bool_], sweeps: int) -> Floats:
    """Return values (H, W, 3) extended to unknown pixels; the result is only valid there."""
    mask = known.view(np.uint8)
    whole = cv2.cvtColor(values, cv2.COLOR_BGR2BGRA)  # sets the fourth channel to 1
    levels = [np.asarray(cv2.copyTo(whole, mask, np.zeros_like(whole)), np.float32)]
    while max(levels[-1].shape[:2]) > 1:
        h, w = levels[-1].shape[:2]
        half = cv2.resize(levels[-1], ((w + 1) // 2, (h + 1) // 2), interpolation=cv2.INTER_AREA)
        levels.append(np.asarray(half.reshape((h + 1) // 2, (w + 1) // 2, 4), np.float32))
    # At the finest scale a pixel is either known or not, so known pixels are copied instead of blended.
    filled = cv2.resize(_settled(levels[1:], sweeps), known.shape[::-1], interpolation=cv2.INTER_LINEAR)
    for _ in range(sweeps):
        filled = cv2.copyTo(values, mask, filled)
        filled = cv2.filter2D(filled, -1, _MEAN, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(filled, np.float32)


def _settled(levels: list[Floats], sweeps: int) -> Floats:
    """Return the filled values (h, w, 3) at the first level of a pyramid of (h, w, 4).

    The fourth channel is the known fraction of a pixel. The other channels are premultiplied by it.
    """
    coarse = np.asarray(levels[-1][..., :3] / np.maximum(levels[-1][..., 3:], 1e-12), np.float32)
    for level in reversed(levels[:-1]):
        h, w = level.shape[:2]
        filled = cv2.resize(coarse, (w, h), interpolation=cv2.INTER_LINEAR).reshape(h, w, 3)
        *own, weight = cv2.split(level)
        share = np.minimum(weight, 1) / np.maximum(weight, 1e-12)
        free = 1 - np.minimum(weight, 1)
        # NumPy takes many times as long to broadcast over the last axis.
        kept = np.asarray(cv2.merge([plane * share for plane in own]), np.float32)
        moving = np.asarray(cv2.merge([free, free, free]), np.float32)
        coarse = kept + moving * np.asarray(filled, np.float32)
        for _ in range(sweeps):
            mean = cv2.filter2D(coarse, -1, _MEAN, borderType=cv2.BORDER_REPLICATE)
            coarse = np.asarray(mean.reshape(h, w, 3), np.float32)
            coarse *= moving
            coarse += kept
    return coarse
