"""Buffers: the larger maps in which lines are found, cropped to the object."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from normalgan.arrays import BoolMask, Doubles
from normalgan.rendering.lines.sight import Sight, sight
from normalgan.rendering.maps import Maps
from normalgan.rendering.view import View

__all__ = ["Buffers"]

_MARGIN = 4  # pixels kept about the object, so that filters meet the background before the border


@dataclass(frozen=True)
class Buffers:
    """The part of a view's maps that holds the object.

    Args:
        maps: (H, W) of the part.
        sight: its lines of sight.
        corner: (x, y) of its upper left corner in the whole maps.
        side: side of the whole picture in pixels.
        scale: pixels of the maps per pixel of the sketch.
    """

    maps: Maps
    sight: Sight
    corner: tuple[int, int]
    side: int
    scale: int

    @classmethod
    def of(cls, view: View, resolution: int) -> Self | None:
        """Return a view's buffers, ``resolution`` pixels a side or somewhat more; None if nothing is seen.

        A side is a whole multiple of the sketch's.
        """
        scale = -(-resolution // view.size)
        whole = view.maps(scale)
        window = _object_window(whole.mask)
        if window is None:
            return None
        # A contiguous copy, because it is read many times.
        maps = Maps(np.ascontiguousarray(whole.normal[window]), whole.depth[window], whole.mask[window])
        side = scale * view.size
        corner = (window[1].start, window[0].start)
        return cls(maps, sight(view.camera, maps, window, side), corner, side, scale)

    def to_sketch(self, points: Doubles) -> Doubles:
        """Return points (P, 2) of the part, x right and y down in its pixels, in pixels of the sketch."""
        placed: Doubles = (points + np.array(self.corner)) / self.scale
        return placed


def _object_window(mask: BoolMask) -> tuple[slice, slice] | None:
    """Return the rows and columns of the object and a margin: an animal fills a fraction of its frame."""
    window = []
    for axis in (1, 0):
        filled = np.flatnonzero(mask.any(axis))
        if not len(filled):
            return None
        end = mask.shape[1 - axis]
        window.append(slice(max(int(filled[0]) - _MARGIN, 0), min(int(filled[-1]) + 1 + _MARGIN, end)))
    return window[0], window[1]
