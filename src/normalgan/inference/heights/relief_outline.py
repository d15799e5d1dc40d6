"""Relief outline: triangulate the pixels of an object and smooth the rim."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

_ROUNDS = 4
"""Number of times the rim is smoothed; more would erode thin legs and ears."""


@dataclass(frozen=True)
class Corners:
    """The triangle mesh of a mask's pixels, with pixel corners as vertices.

    Args:
        place: (n, 2), x right and y down in pixels.
        height: (n,), mean height of the adjacent pixels.
        faces: (m, 3), triangles, counter-clockwise for a viewer in front (y up).
        rim: (r, 2), directed edges along the outline and holes, in the direction of the triangles.
    """

    place: NDArray[np.float64]
    height: NDArray[np.float64]
    faces: NDArray[np.intp]
    rim: NDArray[np.intp]


def corners_of(height: NDArray[np.floating], mask: NDArray[np.bool_]) -> Corners:
    """Return the corners of the pixels of a non-empty mask.

    Where two pixels touch only at a corner, each gets its own vertex, so that every rim edge has exactly one
    neighbour at each end.

    Args:
        height: (H, W), height of each pixel.
        mask: (H, W), the object.

    Example:
        >>> one = corners_of(np.ones((1, 1)), np.ones((1, 1), dtype=bool))
        >>> len(one.place), len(one.faces), len(one.rim)
        (4, 2, 4)
    """
    rows, columns = np.nonzero(mask)
    # Corners of a pixel: 0 upper left, 1 upper right, 2 lower right, 3 lower left.
    down, right = np.array([0, 0, 1, 1]), np.array([0, 1, 1, 0])
    place = np.stack([columns[:, None] + right, rows[:, None] + down], axis=-1)
    key = place[..., 1] * (mask.shape[1] + 1) + place[..., 0]
    _, corner = np.unique(2 * key + _apart(mask, place, rows), return_inverse=True)
    corner = corner.reshape(-1, 4)
    count = int(corner.max()) + 1
    shared = np.bincount(corner.ravel(), minlength=count)
    level = np.bincount(corner.ravel(), np.repeat(height[mask].astype(np.float64), 4), count) / shared
    where = np.empty((count, 2))
    where[corner.ravel()] = place.reshape(-1, 2)
    faces = np.concatenate([corner[:, [0, 3, 2]], corner[:, [0, 2, 1]]])
    rim = _rim(corner)
    smooth = _smoothing(rim, count)
    for _ in range(_ROUNDS):
        where, level = smooth @ where, smooth @ level
    return Corners(where, level, faces, rim)


def _apart(mask: NDArray[np.bool_], place: NDArray[np.intp], rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return 1 (n, 4) where two pixels touch only at a corner, for the lower one of the two; otherwise 0."""
    around = np.pad(mask, 1)
    y, x = place[..., 1], place[..., 0]
    upper_left, upper_right = around[y, x], around[y, x + 1]
    lower_left, lower_right = around[y + 1, x], around[y + 1, x + 1]
    diagonal = (upper_left == lower_right) & (upper_right == lower_left) & (upper_left != upper_right)
    return np.asarray(diagonal & (y == rows[:, None]), np.intp)


def _rim(corner: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the pixel edges that belong to a single pixel, counter-clockwise for a viewer in front."""
    edges = np.concatenate([corner[:, [a, b]] for a, b in ((0, 3), (3, 2), (2, 1), (1, 0))])
    count = int(corner.max()) + 1
    there, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    alone = edges[~np.isin(there, back)]
    return alone.reshape(-1, 2)


def _smoothing(rim: NDArray[np.intp], count: int) -> sparse.csr_array:
    """Return the matrix that moves each rim corner half-way to the midpoint of its two neighbours."""
    start, end = rim.T
    links = sparse.csr_array((np.full(len(rim), 0.25), (start, end)), shape=(count, count))
    own = np.ones(count)
    own[start] = 0.5
    return sparse.csr_array(links + links.T + sparse.diags_array(own))
