"""Extension: normals where the model painted none, from those around, as smoothly as can be."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.normals import Floats, normalize

_SWEEPS = 60


def extend(normals: Floats, known: NDArray[np.bool_], needed: NDArray[np.bool_]) -> Floats:
    """Return unit normals everywhere, (H, W, 3): those known, and a near harmonic extension of them.

    Averages of what is known, at coarser and coarser scales, fill what is not (the push and pull of Gortler
    et al. 1996, "The Lumigraph", 3.3); sweeps that make each pixel the mean of its neighbours, the discrete
    Laplace equation with what is known as boundary values, then take the coarse scales' steps out.

    Args:
        normals: (H, W, 3), unit where known.
        known: (H, W), True somewhere.
        needed: (H, W), where it matters: the deeper a hole there is, the more sweeps are made.
    """
    if known.all():
        return normals
    filled = _pushed_and_pulled(np.where(known[..., None], normals, 0).astype(np.float32), known)
    mean = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], np.float32) / 4
    away = cv2.distanceTransform((~known).astype(np.uint8), cv2.DIST_L2, 3)
    deepest = float(away[needed].max()) if needed.any() else 0.0
    for _ in range(min(_SWEEPS, int(4 * deepest))):
        relaxed = cv2.filter2D(filled, -1, mean, borderType=cv2.BORDER_REPLICATE)
        filled = np.where(known[..., None], normals, relaxed).astype(np.float32)
    unit = normalize(filled)
    # Opposite neighbours cancel at a point; there the surface faces the viewer.
    unit[np.abs(unit).sum(-1) == 0] = (0, 0, 1)
    return np.where(known[..., None], normals, unit)


def _pushed_and_pulled(values: Floats, known: NDArray[np.bool_]) -> Floats:
    levels = [np.dstack([values, known.astype(np.float32)])]
    while max(levels[-1].shape[:2]) > 1:
        h, w = levels[-1].shape[:2]
        half = cv2.resize(levels[-1], ((w + 1) // 2, (h + 1) // 2), interpolation=cv2.INTER_AREA)
        levels.append(np.asarray(half.reshape((h + 1) // 2, (w + 1) // 2, 4), np.float32))
    coarse = np.asarray(levels[-1][..., :3] / np.maximum(levels[-1][..., 3:], 1e-12), np.float32)
    for level in reversed(levels[:-1]):
        h, w = level.shape[:2]
        up = cv2.resize(coarse, (w, h), interpolation=cv2.INTER_LINEAR).reshape(h, w, 3)
        weight = np.minimum(level[..., 3:], 1)
        own = level[..., :3] / np.maximum(level[..., 3:], 1e-12)
        coarse = np.asarray(weight * own + (1 - weight) * up, np.float32)
    return coarse
