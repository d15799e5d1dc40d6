"""Pens: from lines through pixels to the strokes that draw them."""

from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.crossings import Line
from normalgan.rendering.strokes.curves import SPACING, resample, settle, smooth
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["draw_border", "draw_curve"]

_STAIRS = 4.0  # points over which a line is smoothed that is known only to pass between two pixels
_SLACK = 0.5  # pixels from the border of two pixels to their centres; the line passes within it
_JITTER = 1.5  # points over which a more precise line is smoothed


def draw_border(line: Line, buffers: Buffers, width: float) -> Stroke:
    """Return the stroke along a line known only to pass between certain pixels."""
    path = settle(line.points, _STAIRS, _SLACK)
    return Stroke.even(resample(buffers.to_sketch(path), SPACING), width)


def draw_curve(line: Line, buffers: Buffers, width: float) -> Stroke:
    """Return the stroke along a line with subpixel points."""
    path = smooth(line.points, _JITTER)
    return Stroke.even(resample(buffers.to_sketch(path), SPACING), width)
