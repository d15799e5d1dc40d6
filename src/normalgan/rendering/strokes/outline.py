"""The shape that a stroke of varying width covers, as closed outlines."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["outline"]

_CAP = 6  # corners of a round end, invisible at the width of a pen


def outline(stroke: Stroke) -> list[Doubles]:
    """Return the rings, (R, 2) each without repeating the first point, whose nonzero fill the stroke covers.

    Its two sides, half a width away from the points, joined by round ends; a closed stroke has a ring a side.

    >>> bar = Stroke.even(np.array([[0.0, 0.0], [4.0, 0.0]]), width=2)
    >>> [ring.round().astype(int)[:2].tolist() for ring in outline(bar)]
    [[[0, 1], [4, 1]]]
    """
    along = _tangents(stroke.points, stroke.closed)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) * stroke.width[:, None] / 2
    left, right = stroke.points + across, stroke.points - across
    if stroke.closed:
        return [left[:-1], right[:0:-1]]
    first, last = (
        _cap(stroke.points[end], sign * across[end], stroke.width[end]) for end, sign in ((0, -1), (-1, 1))
    )
    return [np.concatenate([left, last, right[::-1], first])]


def _tangents(points: Doubles, closed: bool) -> Doubles:
    """Return unit vectors along the stroke at each of its points."""
    steps = np.diff(points, axis=0)
    if closed:
        before, after = np.vstack([steps[-1:], steps]), np.vstack([steps, steps[:1]])
    else:
        before, after = np.vstack([steps[:1], steps]), np.vstack([steps, steps[-1:]])
    tangents = before + after
    # Where the pen turns back on itself the two steps cancel; use the direction it came from.
    still = np.linalg.norm(tangents, axis=1) < 1e-9
    tangents[still] = before[still]
    unit: Doubles = tangents / np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12)
    return unit


def _cap(end: Doubles, side: Doubles, width: float) -> Doubles:
    """Return the corners of a half circle about ``end`` that begins beyond ``side`` and turns clockwise."""
    angles = np.linspace(0, np.pi, _CAP + 2)[1:-1]
    radius = width / 2
    start = side / max(float(np.linalg.norm(side)), 1e-12)
    over = np.array([start[1], -start[0]])
    corners: Doubles = end + radius * (np.cos(angles)[:, None] * start + np.sin(angles)[:, None] * over)
    return corners
