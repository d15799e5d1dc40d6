"""Inflation: inflate a silhouette, as a baseline without learning."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from normalgan.arrays import BoolMask, Doubles, Floats
from normalgan.normals import normalize

_SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))  # (rows, columns) to the four neighbours


def inflate(mask: BoolMask) -> Doubles:
    """Return the squared height (H, W) of an inflated silhouette, in pixels²; 0 off the silhouette.

    This is the solution of Δh = -4 on the object with h = 0 on its outline, which runs between pixels. For a
    disc of radius R it is R² - r², so the height √h is a hemisphere; for an ellipse it is an ellipsoid.

    Args:
        mask: (H, W) True on the object.

    References:
        Johnston 2002, "Lumo: Illumination for Cel Animation", NPAR: normals from outlines by diffusion.
        Baran and Lehtinen 2009, "Notes on Inflating Curves": the square root of a Poisson equation's
        solution.
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
        # The outline is half a pixel away, so the value beyond it is the negative of the value here.
        diagonal += np.where(linked, 1.0, 2.0)
        rows.append(here[linked])
        columns.append(there[linked])
    i, j = np.concatenate([here, *rows]), np.concatenate([here, *columns])
    values = np.concatenate([diagonal, np.full(len(i) - count, -1.0)])
    height[mask] = spsolve(coo_array((values, (i, j)), shape=(count, count)).tocsc(), np.full(count, 4.0))
    return height


def inflated_normals(mask: BoolMask) -> Floats:
    """Return the normals (H, W, 3) of an inflated silhouette, x right, y up, z to the viewer; 0 off it.

    Args:
        mask: (H, W) True on the object.

    Example:
        >>> normals = inflated_normals(np.ones((1, 1), bool))
        >>> normals[0, 0].tolist()
        [0.0, 0.0, 1.0]
    """
    height = np.pad(inflate(mask), 1)
    inner = np.pad(mask, 1)
    # The solution continues beyond the outline with the opposite sign.
    right, left, down, up = (
        np.where(_beside(inner, step), _beside(height, step), -height)[inner] for step in _SIDES
    )
    normals = np.zeros((*mask.shape, 3))
    # √h is infinitely steep at the outline, but its gradient times 2√h is the gradient of h, which is finite.
    normals[mask] = np.stack([(left - right) / 2, (down - up) / 2, 2 * np.sqrt(height[inner])], axis=-1)
    return normalize(normals.astype(np.float32))


def _beside(array: NDArray[Any], step: tuple[int, int]) -> NDArray[Any]:
    """Return each pixel's neighbour; the array has an empty border, so wrapping is harmless."""
    return np.roll(array, (-step[0], -step[1]), axis=(0, 1))
