"""Rasteriser: strokes to ink, antialiased, width and darkness changing along them."""

from collections.abc import Sequence

import numpy as np

from normalgan.rendering.maps import Floats
from normalgan.rendering.strokes.stroke import Doubles, Stroke

_LONGEST = 2.0  # pixels: longer segments are cut up, so that what lies about each is a small square


def rasterise(strokes: Sequence[Stroke], size: int) -> Floats:
    """Return the ink of strokes laid one over the other, (``size``, ``size``) in [0, 1].

    A pixel's coverage is that of a bar as wide as the line, at the pixel's distance from it, by a box a
    pixel wide: exact for upright and level lines, and in total for all. Ends are round. One stroke covers
    a pixel once, however it winds; two strokes that cross darken each other, as pencil does:
    ``1 - (1 - a) (1 - b)``. What lies outside the frame is cut off.

    >>> line = Stroke.even(np.array([[-5.0, 2.0], [9.0, 2.0]]), width=1.0)
    >>> rasterise([line], 4)[:, 0].tolist()
    [0.0, 0.5, 0.5, 0.0]
    """
    paper = np.ones((size, size), np.float32)
    for stroke in strokes:
        _lay(stroke, paper)
    ink: Floats = 1 - paper
    return ink


def _lay(stroke: Stroke, paper: Floats) -> None:
    """Darken the (H, W) share of ``paper`` that shows, by one stroke."""
    size = len(paper)
    bound = stroke.width.max() / 2 + 0.5  # pixels from the line that may get ink
    points, width, darkness = _cut(stroke)
    # Only segments near the frame matter.
    near = ((points > -bound - _LONGEST) & (points < size + bound + _LONGEST)).all(axis=1)
    chosen = np.flatnonzero(near[:-1] & near[1:])
    if not len(chosen):
        return
    start, step = points[chosen], np.diff(points, axis=0)[chosen]
    low = np.minimum(start, start + step)
    corner = np.floor(low - bound).astype(np.int64)
    side = int(np.ceil(2 * bound + np.abs(step).max())) + 1
    down, right = np.indices((side, side)).reshape(2, 1, -1)
    column, row = corner[:, :1] + right, corner[:, 1:] + down
    # From each segment's start to the pixels' centres; single precision will do from here on.
    x = (corner[:, :1] - start[:, :1] + 0.5).astype(np.float32) + right.astype(np.float32)
    y = (corner[:, 1:] - start[:, 1:] + 0.5).astype(np.float32) + down.astype(np.float32)
    dx, dy = step.astype(np.float32).T[:, :, None]
    at = np.clip((x * dx + y * dy) / np.maximum(dx * dx + dy * dy, np.float32(1e-12)), 0, 1)
    distance = np.hypot(x - at * dx, y - at * dy)
    wide, dark = (_along(values, chosen, at) for values in (width, darkness))
    # A line thinner than a pixel covers no pixel wholly.
    ink = np.clip(wide / 2 + 0.5 - distance, 0, np.minimum(wide, 1)) * dark
    seen = (ink > 0) & (column >= 0) & (column < size) & (row >= 0) & (row < size)
    row, column, ink = row[seen], column[seen], ink[seen]
    if not len(ink):
        return
    top, left = row.min(), column.min()
    own = np.zeros((row.max() - top + 1, column.max() - left + 1), np.float32)
    np.maximum.at(own, (row - top, column - left), ink)
    paper[top : top + own.shape[0], left : left + own.shape[1]] *= 1 - own


def _cut(stroke: Stroke) -> tuple[Doubles, Doubles, Doubles]:
    """Return points (P, 2), widths (P,) and darknesses (P,) with no segment longer than `_LONGEST`."""
    steps = np.hypot(*np.diff(stroke.points, axis=0).T)
    pieces = np.maximum(np.ceil(steps / _LONGEST), 1).astype(np.int64)
    if (pieces == 1).all():
        return stroke.points, stroke.width, stroke.darkness
    stops = np.concatenate([[0], np.cumsum(pieces)])
    place = np.interp(np.arange(stops[-1] + 1), stops, np.arange(len(stops)))
    known = np.arange(len(stops))
    x, y, width, darkness = (
        np.interp(place, known, values) for values in (*stroke.points.T, stroke.width, stroke.darkness)
    )
    return np.stack([x, y], axis=1), width, darkness


def _along(values: Doubles, chosen: np.ndarray, at: Floats) -> Floats:
    """Return what the values (P,) at the points are at the shares ``at`` (S, K) of the chosen segments."""
    start = values[chosen].astype(np.float32)[:, None]
    step = np.diff(values)[chosen].astype(np.float32)[:, None]
    mixed: Floats = start + at * step
    return mixed
