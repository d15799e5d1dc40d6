"""Flat outlines: how far from them a point is, and how they are rounded."""

from collections.abc import Sequence

import numpy as np

from normalgan.animals.sweep import Floats, Volume


def outline_distance(outline: Floats, u: Volume, v: Volume) -> Volume:
    """Return the signed distance of points to a closed polygon, negative inside.

    The least distance to an edge, its sign by the number of edges crossed (Quilez, "2D distance functions").

    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> outline_distance(square, np.float32([1, 3]), np.float32([1, 1])).tolist()
    [-1.0, 1.0]
    """
    square = np.full(u.shape, np.inf, np.float32)
    inside = np.zeros(u.shape, np.bool_)
    ends = outline.astype(np.float32)
    for (ax, ay), (bx, by) in zip(ends, np.roll(ends, -1, axis=0), strict=True):
        ex, ey, dx, dy = bx - ax, by - ay, u - ax, v - ay
        t = np.clip((dx * ex + dy * ey) / max(ex * ex + ey * ey, np.float32(1e-12)), 0, 1)
        np.minimum(square, (dx - t * ex) ** 2 + (dy - t * ey) ** 2, out=square)
        inside ^= ((v >= ay) != (v >= by)) & ((dx * ey < dy * ex) == (by > ay))
    return np.where(inside, -np.sqrt(square), np.sqrt(square))


def rounded(corners: Sequence[tuple[float, float]], times: int = 2) -> Floats:
    """Return a closed outline with its corners cut (Chaikin, 1974); a corner given twice stays sharper."""
    points = np.array(corners, dtype=np.float64)
    for _ in range(times):
        after = np.roll(points, -1, axis=0)
        points = np.stack([0.75 * points + 0.25 * after, 0.25 * points + 0.75 * after], 1).reshape(-1, 2)
    return points
