"""Height pyramid: halve a normal map, and bring its heights back to full size."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.inference.network.tile import Tile, repeats

_STEEPEST = 0.2
"""Minimum nz for a slope within a pixel; the slope only affects the initial guess at the next level."""

Vectors = NDArray[np.float64]


def halve(normals: Vectors, mask: BoolMask, tile: Tile | None = None) -> tuple[Vectors, BoolMask]:
    """Return a map at half the size: its normals (h, w, 3), averaged over 2 × 2 pixels, and its mask.

    Args:
        normals: (H, W, 3), zero off the mask.
        mask: (H, W), the object.
        tile: directions in which the map repeats.
    """
    for axis, goes_on in enumerate(repeats(tile)):
        if mask.shape[axis] % 2:
            edge = [(0, int(axis == each)) for each in (0, 1)]
            how: Literal["wrap", "constant"] = "wrap" if goes_on else "constant"
            mask, normals = np.pad(mask, edge, how), np.pad(normals, (*edge, (0, 0)), how)
    quarters = [np.s_[i::2, j::2] for i in (0, 1) for j in (0, 1)]
    total = sum((normals[quarter] for quarter in quarters[1:]), normals[quarters[0]])
    there = mask[quarters[0]] | mask[quarters[1]] | mask[quarters[2]] | mask[quarters[3]]
    length = np.linalg.norm(total, axis=-1, keepdims=True)
    return total / np.maximum(length, 1e-9), there


def double(height: Vectors, normals: Vectors) -> Vectors:
    """Return the heights (H, W) of a map (H, W, 3) from the heights (h, w) at half its size.

    Each pixel becomes four. Each of them lies on a plane through the old centre with its own normal, so that
    a jump between pixels stays a jump.
    """
    rows, columns = normals.shape[:2]
    coarse = 2 * np.repeat(np.repeat(height, 2, 0)[:rows], 2, 1)[:, :columns]
    facing = np.maximum(normals[..., 2], _STEEPEST)
    right = np.where(np.arange(columns) % 2, 0.5, -0.5)[None]
    up = np.where(np.arange(rows) % 2, -0.5, 0.5)[:, None]
    return coarse - (normals[..., 0] * right + normals[..., 1] * up) / facing
