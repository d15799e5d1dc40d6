"""Unrolling: flatten a surface, so that patterns placed on it get narrower towards the rim."""

from math import ceil
from typing import cast

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats

_SIDE = 64
"""Maximum number of cells along a side of the grid; a coarse grid is enough, because the result is smooth."""
_LEAST = 0.3
"""Minimum nz, so that a pixel of the map covers at most three pixels of the surface; more would alias."""
_SLACK = 1e-3
"""Weight of steps off the object, which continue the grid past the rim."""
_GROUND = 1e-6
"""Weight of a pull of every cell towards its position, without which all cells could move together."""


def unroll(normals: Floats, mask: BoolMask) -> Floats:
    """Return the displacement (H, W, 2) of each pixel, right and down, when the surface is flattened.

    The mean displacement of the object is zero. A step in the direction in which the surface leans is longer
    on the surface than in the picture, by a factor of 1 / nz. No flat map preserves all lengths; this one
    fits them in the least-squares sense.

    Args:
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.

    Example:
        On a cylinder, a point at 0.8 of the radius is 0.93 radii from the axis, measured along the surface:

        >>> x = np.tile((np.arange(200) - 99.5) / 100, (200, 1))
        >>> cylinder = np.dstack([x, 0 * x, np.sqrt(1 - x**2)]).astype(np.float32)
        >>> moved = unroll(cylinder, np.ones_like(x, bool))
        >>> round(0.8 + float(moved[100, 179, 0] - moved[100, 99, 0]) / 100, 2)
        0.93
    """
    from scipy import sparse  # here because it is slow to import
    from scipy.sparse.linalg import splu

    height, width = mask.shape
    side = ceil(max(height, width) / _SIDE)
    share, stretch = _cells(normals, mask, side)
    rows, columns = share.shape
    down, across = (
        sparse.diags_array([-1.0, 1.0], offsets=[0, 1], shape=(count - 1, count)) for count in share.shape
    )
    steps = sparse.vstack(
        [sparse.kron(sparse.eye_array(rows), across), sparse.kron(down, sparse.eye_array(columns))]
    )
    weight = np.concatenate(
        [np.minimum(share[:, 1:], share[:, :-1]).ravel(), np.minimum(share[1:], share[:-1]).ravel()]
    )
    right, below = stretch[:, 1:, 0] + stretch[:, :-1, 0], stretch[1:, :, 1] + stretch[:-1, :, 1]
    longer = side / 2 * np.concatenate([right.reshape(-1, 2), below.reshape(-1, 2)])
    pulls = steps.T @ sparse.diags_array(weight + _SLACK)
    matrix = pulls @ steps + _GROUND * sparse.eye_array(rows * columns)
    moved = splu(matrix.tocsc()).solve(pulls @ longer)
    moved -= share.ravel() @ moved / max(float(share.sum()), 1e-9)
    grid = moved.reshape(rows, columns, 2).astype(np.float32)
    enlarged = cv2.resize(grid, (side * columns, side * rows), interpolation=cv2.INTER_LINEAR)
    return cast(Floats, enlarged[:height, :width])


def _cells(normals: Floats, mask: BoolMask, side: int) -> tuple[Doubles, Doubles]:
    """Return the fraction of object in each cell (h, w), and the stretch (h, w, 2, 2) of each cell.

    The stretch is the additional displacement (right, down) of a unit step to the right and of a unit step
    down.
    """
    below, beyond = (-extent % side for extent in mask.shape)
    seen = np.dstack([normals * mask[..., None], mask.astype(np.float32)])
    whole = cv2.copyMakeBorder(seen, 0, below, 0, beyond, cv2.BORDER_CONSTANT)
    size = whole.shape[1] // side, whole.shape[0] // side
    means = cv2.resize(whole, size, interpolation=cv2.INTER_AREA).astype(np.float64)
    right, up, front, share = np.moveaxis(means, -1, 0)
    length, flat = np.maximum(np.sqrt(right**2 + up**2 + front**2), 1e-9), np.maximum(right**2 + up**2, 1e-18)
    longer = np.where(share > 0, 1 / np.maximum(front / length, _LEAST) - 1, 0) / flat
    xx, xy, yy = longer * right * right, -longer * right * up, longer * up * up
    return share, np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
