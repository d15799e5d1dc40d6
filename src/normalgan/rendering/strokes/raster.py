"""Rasteriser: antialiased strokes with varying width and darkness."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.rendering.strokes.stroke import Stroke

_LONGEST_SEGMENT = 2.0  # maximum length of a segment in pixels, so that each affects only a small square
_FAINTEST_INK = 1e-4  # smaller amounts of ink are rounding errors
_BATCH_PIXELS = 1_000_000  # number of pixels processed at once


def rasterise(strokes: Sequence[Stroke], size: int) -> Floats:
    """Return the ink of overlaid strokes, (``size``, ``size``) in [0, 1].

    The coverage of a pixel is that of an infinite bar with the local width, direction and distance of the
    line, which is exact along straight lines. Ends are round. A stroke covers a pixel only once, even if
    it crosses itself. Crossing strokes darken each other like pencil: ``1 - (1 - a) (1 - b)``. Strokes are
    clipped to the frame.

    >>> line = Stroke.even(np.array([[-5.0, 2.0], [9.0, 2.0]]), width=1.0)
    >>> rasterise([line], 4)[:, 0].round(2).tolist()
    [0.0, 0.5, 0.5, 0.0]
    """
    paper = np.ones((size, size), np.float32)
    segments = _segments(strokes, size)
    dots = [_dots(alike, size) for alike in segments.batches()]
    if dots:
        owner, row, column, ink = (np.concatenate(parts) for parts in zip(*dots, strict=True))
        _lay(owner, row, column, ink, paper)
    return np.clip(1 - paper, 0, 1)


@dataclass(frozen=True)
class _Segments:
    """The straight segments of strokes, as arrays (S,) or (S, 2).

    Args:
        start: start points.
        step: vectors from the start to the end points.
        pen: width and darkness at the start.
        change: change of width and darkness from start to end.
        owner: index of the stroke.
        reach: distance in pixels from the segment that may get ink.
        side: side of a square of pixels that contains all inked pixels of any segment.
    """

    start: Doubles
    step: Doubles
    pen: Doubles
    change: Doubles
    owner: Indices
    reach: Doubles
    side: Indices

    def of(self, chosen: BoolMask | Indices) -> "_Segments":
        return _Segments(*(part[chosen] for part in vars(self).values()))

    def batches(self) -> Iterator["_Segments"]:
        """Yield batches of segments with the same side, small enough for their squares to fit into memory."""
        for side in np.unique(self.side):
            alike = np.flatnonzero(self.side == side)
            count = max(int(_BATCH_PIXELS // side**2), 1)
            yield from (self.of(alike[k : k + count]) for k in range(0, len(alike), count))


def _segments(strokes: Sequence[Stroke], size: int) -> _Segments:
    """Return the segments of strokes that may ink a picture of ``size`` pixels."""
    cut = [_cut(stroke) for stroke in strokes] or [(np.zeros((1, 2)), np.zeros((1, 2)))]
    points, pens = (np.concatenate(part) for part in zip(*cut, strict=True))
    number = np.repeat(np.arange(len(cut)), [len(part) for part, _ in cut])
    reach = np.array([pen[:, 0].max() / 2 + 0.5 for _, pen in cut])[number]
    step = np.diff(points, axis=0)
    # Based on the longest segment of the stroke, so that there are few different sizes.
    longest = np.zeros(len(cut))
    np.maximum.at(longest, number[:-1], np.where(number[:-1] == number[1:], np.abs(step).max(axis=1), 0))
    side = (np.ceil(2 * reach + longest[number]) + 1).astype(np.int64)
    low, high = np.minimum(points[:-1], points[1:]), np.maximum(points[:-1], points[1:])
    near = ((high > -reach[:-1, None]) & (low < size + reach[:-1, None])).all(axis=1)
    chosen = np.flatnonzero(near & (number[:-1] == number[1:]))
    start, pen = points[:-1], pens[:-1]
    everything = _Segments(start, step, pen, np.diff(pens, axis=0), number[:-1], reach[:-1], side[:-1])
    return everything.of(chosen)


def _cut(stroke: Stroke) -> tuple[Doubles, Doubles]:
    """Return points (P, 2) and pens (P, 2), with consecutive points at most `_LONGEST_SEGMENT` apart."""
    pens = np.stack([stroke.width, stroke.darkness], axis=1)
    steps = np.hypot(*np.diff(stroke.points, axis=0).T)
    pieces = np.maximum(np.ceil(steps / _LONGEST_SEGMENT), 1).astype(np.int64)
    if (pieces == 1).all():
        return stroke.points, pens
    stops = np.concatenate([[0], np.cumsum(pieces)])
    wanted = np.arange(stops[-1] + 1)
    columns = [np.interp(wanted, stops, values) for values in (*stroke.points.T, *pens.T)]
    return np.stack(columns[:2], axis=1), np.stack(columns[2:], axis=1)


def _dots(segments: _Segments, size: int) -> tuple[Indices, Indices, Indices, Floats]:
    """Return stroke, row, column and amount of ink, (D,) each, of each pixel that segments ink.

    The squares of all segments have the same side. A pixel may occur several times.
    """
    side = int(segments.side[0])
    low = np.minimum(segments.start, segments.start + segments.step) - segments.reach[:, None]
    corner = np.floor(low)
    # Relative to each segment's start, so single precision is enough from here on.
    offset = (corner - segments.start + 0.5).astype(np.float32)
    steps = np.arange(side, dtype=np.float32)
    x, y = offset[:, :1, None] + steps, offset[:, 1:, None] + steps[:, None]
    dx, dy = segments.step.astype(np.float32).T[:, :, None, None]
    at = (x * dx + y * dy) / np.maximum(dx * dx + dy * dy, np.float32(1e-12))
    np.clip(at, 0, 1, out=at)
    distance = np.sqrt(np.square(x - at * dx) + np.square(y - at * dy))
    wide, dark = segments.pen.astype(np.float32).T[:, :, None, None]
    wider, darker = segments.change.astype(np.float32).T[:, :, None, None]
    width = wide + at * wider
    half = np.float32(0.5) * width
    slant = np.abs(segments.step) / np.maximum(np.hypot(*segments.step.T), 1e-12)[:, None]
    slant[(segments.step == 0).all(axis=1), 0] = 1  # a dot, where any direction will do
    ink = _covered(half - distance, slant) - _covered(-half - distance, slant)
    ink *= dark + at * darker
    which, down, right = np.nonzero(ink > _FAINTEST_INK)
    row, column = corner[which].astype(np.int64).T[::-1] + np.stack([down, right])
    inside = (row >= 0) & (row < size) & (column >= 0) & (column < size)
    owner = segments.owner[which]
    return owner[inside], row[inside], column[inside], ink[which, down, right][inside]


def _covered(depth: Floats, slant: Doubles) -> Floats:
    """Return the fraction of a pixel on one side of a line, given the signed distance of the pixel's centre.

    Projected along the line, the pixel's square is the convolution of two boxes with the widths of the
    direction's components. The fraction is the integral of that.

    Args:
        depth: (S, K, K) signed distances in pixels, negative on the other side.
        slant: (S, 2) absolute components of the line's direction; (1, 0) or (0, 1) are axis-aligned.
    """
    # The formula divides by the smaller component, which is 0 for axis-aligned lines; this slant is
    # invisible.
    wide, narrow = np.sort(np.maximum(slant, 0.02), axis=1).astype(np.float32).T[::-1, :, None, None]
    outer, inner = np.float32(0.5) * (wide + narrow), np.float32(0.5) * (wide - narrow)
    depth = np.clip(depth, -outer, outer)
    fraction: Floats = np.square(depth + outer)
    fraction -= np.square(np.maximum(depth + inner, 0))
    fraction -= np.square(np.maximum(depth - inner, 0))
    fraction /= 2 * wide * narrow
    return fraction


def _lay(owner: Indices, row: Indices, column: Indices, ink: Floats, paper: Floats) -> None:
    """Darken ``paper`` (H, W), the fraction still visible; a stroke inks a pixel once, with its maximum."""
    size = len(paper)
    # Each pixel of a stroke has its own index, so that a pixel inked several times counts once.
    key = (owner * size + row) * size + column
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]])) if len(key) else key
    most = np.maximum.reduceat(ink[order], first) if len(key) else ink
    np.multiply.at(paper.reshape(-1), key[first] % (size * size), 1 - most)
