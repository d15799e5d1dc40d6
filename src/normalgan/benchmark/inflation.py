"""Inflation: the normals of an inflated silhouette, a baseline without learning."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from normalgan.arrays import BoolMask, Doubles, Floats
from normalgan.normals import normalize

__all__ = ["inflate", "inflated_normals"]

_SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))  # (rows, columns) to the four neighbours


def inflate(mask: BoolMask) -> Doubles:
    """Return the squared height of an inflated silhouette, in pixels², (H, W), 0 off it.

    It solves Δh = -4 on the object with h = 0 on its outline, which runs between pixels. Of a disc of
    radius R it is R² - r², so that the height √h is a hemisphere; of an ellipse, an ellipsoid.

    Args:
        mask: (H, W) True on the object.

    References:
        Johnston 2002, "Lumo: Illumination for Cel Animation", NPAR: normals from outlines by diffusion.
        Baran and Lehtinen 2009, "Notes on Inflating Curves": the root of the solution of Poisson's equation.
    """
    height = np.zeros(mask.shape)
    count = int(mask.sum())
    if not count:
        return height
    inner = np.pad(mask, 1)
    number = np.full(inner.shape, -1)
    number[inner] = np.arange(count)
    here = number[inner]
    diagonal = np.zeros(count)
    rows, columns = [], []
    for step in _SIDES:
        there = _beside(number, step)[inner]
        linked = there >= 0
        # The outline is half a pixel away, and the value beyond it is the negative of the one here.
        diagonal += np.where(linked, 1.0, 2.0)
        rows.append(here[linked])
        columns.append(there[linked])
    i, j = np.concatenate([here, *rows]), np.concatenate([here, *columns])
    values = np.concatenate([diagonal, np.full(len(i) - count, -1.0)])
    height[mask] = spsolve(coo_array((values, (i, j)), shape=(count, count)).tocsc(), np.full(count, 4.0))
    return height


def inflated_normals(mask: BoolMask) -> Floats:
    """Return the normals of an inflated silhouette, (H, W, 3), x right, y up, z to the viewer; 0 off it.

    Args:
        mask: (H, W) True on the object.

    Example:
        >>> normals = inflated_normals(np.ones((1, 1), bool))
        >>> normals[0, 0].tolist()
        [0.0, 0.0, 1.0]
    """
    height = np.pad(inflate(mask), 1)
    inner = np.pad(mask, 1)
    # Beyond the outline the solution continues with the opposite sign.
    right, left, down, up = (
        np.where(_beside(inner, step), _beside(height, step), -height)[inner] for step in _SIDES
    )
    normals = np.zeros((*mask.shape, 3))
    # √h is infinitely steep at the outline; times 2√h its gradient is that of h, and the normal is finite.
    normals[mask] = np.stack([(left - right) / 2, (down - up) / 2, 2 * np.sqrt(height[inner])], axis=-1)
    return normalize(normals.astype(np.float32))


def _beside(array: NDArray[Any], step: tuple[int, int]) -> NDArray[Any]:
    """Return each pixel's neighbour; the array has an empty border, over which it may wrap."""
    return np.roll(array, (-step[0], -step[1]), axis=(0, 1))
