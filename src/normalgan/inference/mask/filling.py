"""Filling: the area that lines enclose, with small gaps closed by thicker lines."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask
from normalgan.inference.cleaning.silhouette import enclosed_by
from normalgan.inference.network.framing import around
from normalgan.inference.network.line_width import line_width

__all__ = [
    "MARGIN",
    "Filling",
]

_SMALL_GAPS = (0.0, 0.005, 0.012, 0.018)
"""Half the widths of gaps that are closed in any case, as shares of the span."""
_WIDE_GAPS = (0.026, 0.04, 0.06)
"""Half the widths of gaps that are closed if most of the outline is open."""
MARGIN = max(_WIDE_GAPS)
"""Room that lines need around them to be made thicker, as a share of the span."""
_CLOSED = 0.93
"""An outline is closed once as much of the ink encloses something; the rest are whiskers."""
_WINDOW = 7.0
"""Pixels; up to as many, a window is faster than distances."""


class Filling:
    """An inside that grows while gaps are closed.

    Args:
        inked: (H, W), the lines, with room around them.
        span: longer side of what they cover, in pixels.

    Attributes:
        closed: share of the ink that lies in or around the inside.
    """

    def __init__(self, inked: BoolMask, span: int) -> None:
        self._inked, self._span, self._width = inked, span, line_width(inked)
        self._inside = np.zeros_like(inked)
        self._near = self._inside  # what lies in the inside or around it
        self.closed = 0.0

    def fill(self) -> None:
        """Close small gaps, until nearly all lines enclose something."""
        self._take_up_to(_SMALL_GAPS)

    def guess(self) -> bool:
        """Close wide gaps, until nearly all lines enclose something; return whether that helped."""
        before = self.closed
        self._take_up_to(_WIDE_GAPS)
        return self.closed > before

    def mask(self) -> BoolMask:
        """Return the inside with its lines."""
        if not self._inside.any():
            return self._inside
        # The lines at its edge belong to it, and so do eyes and stripes, whatever they are drawn with.
        return enclosed_by(self._inside | (self._inked & self._near))

    def _take_up_to(self, gaps: tuple[float, ...]) -> None:
        for gap in gaps:
            if self.closed > _CLOSED:
                break
            self._take(gap * self._span)

    def _take(self, gap: float) -> None:
        """Add the area enclosed by lines made thicker by ``gap`` on either side."""
        thick = _thicker(self._inked, gap)
        fresh = enclosed_by(thick) & ~thick & ~self._inside
        if not fresh.any():
            return
        self._inside = self._inside | (_grown(fresh, self._inked, gap) if gap else fresh)
        self._near = _thicker(self._inside, self._width + 1.5)
        near = int(np.count_nonzero(self._inked & self._near))
        self.closed = near / int(np.count_nonzero(self._inked))


def _grown(seeds: BoolMask, barrier: BoolMask, reach: float) -> BoolMask:
    """Grow seeds by ``reach`` pixels without crossing a barrier."""
    box = around(seeds, int(reach) + 1)
    free = (~barrier[box] & _thicker(seeds[box], reach + 0.5)).astype(np.uint8)
    grown = seeds[box].astype(np.uint8)
    # Steps to the side only: the pixels of a slanted line may touch at their corners only.
    step = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    for _ in range(int(np.ceil(reach * np.sqrt(2)))):
        grown = np.minimum(cv2.dilate(grown, step), free)
    whole = np.zeros_like(seeds)
    whole[box] = grown > 0
    return whole


def _thicker(marked: BoolMask, reach: float) -> BoolMask:
    """Dilate marked pixels (H, W) by ``reach`` pixels."""
    if reach < 1:
        return marked
    if reach < _WINDOW:
        along = np.arange(-int(reach), int(reach) + 1)
        disc = (np.hypot(along, along[:, None]) <= reach).astype(np.uint8)
        return np.asarray(cv2.dilate(marked.astype(np.uint8), disc) > 0)
    away = cv2.distanceTransform((~marked).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(away <= reach)
