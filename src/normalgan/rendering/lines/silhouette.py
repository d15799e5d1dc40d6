"""Silhouette: the outline alone."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import BoolMask
from normalgan.ranges import NonNegative, Positive, PositiveInt, check_ranges
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.crossings import PAIRS, Crossed, Crossings, crossings
from normalgan.rendering.lines.pens import draw_border
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["Silhouette", "borders"]


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class Silhouette(LineDrawing):
    """The outline alone: where the object borders on the background, outside and through holes.

    Args:
        line_width: width of the line in pixels of the sketch, at any sketch size.
        shortest: parts of the outline that span less than this fraction of the frame's side are left out.
        resolution: side in pixels of the maps that the outline is found in, rounded up to a multiple of
            the sketch's; it is placed between their pixels.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: Positive = 1.25
    shortest: NonNegative = 0.05
    resolution: PositiveInt = 512

    def __post_init__(self) -> None:
        check_ranges(self)

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes; see `LineDrawing.trace`."""
        buffers = Buffers.of(view, self.resolution)
        if buffers is None:
            return []
        lines = borders(buffers.maps.mask).lines(0, self.shortest * buffers.side)
        return [draw_border(line, buffers, self.line_width) for line in lines]


def borders(mask: BoolMask) -> Crossings:
    """Return the border of a mask (H, W); the frame's border does not count."""
    pairs: list[Crossed] = []
    for one, two in PAIRS:
        row, column = np.nonzero(mask[one] != mask[two])
        second = mask[two][row, column]
        count = len(row)
        pairs.append((row, column, np.full(count, 0.5), np.ones(count, np.float32), second))
    return crossings((pairs[0], pairs[1]), mask.shape[1])
