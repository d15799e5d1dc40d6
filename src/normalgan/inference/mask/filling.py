"""Filling: what lines enclose, while their gaps are closed step by step."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask
from normalgan.inference.cleaning.silhouette import enclosed_by
from normalgan.inference.mask.bridging import Bridge, bridges
from normalgan.inference.mask.limbs import limbs
from normalgan.inference.mask.stroke_ends import stroke_ends
from normalgan.inference.network.framing import around
from normalgan.inference.network.line_width import line_width

__all__ = [
    "MARGIN",
    "Filling",
]

_STEPS = (
    *((0.0, 0.0), (0.005, 0.0), (0.012, 0.0)),
    *((0.005, 0.08), (0.005, 0.16), (0.005, 0.25)),
    *((0.022, 0.25), (0.035, 0.25)),
)
"""Half the widths of the gaps that thick lines close, and the costs of bridges, as shares of the span."""
MARGIN = max(gap for gap, _ in _STEPS)
"""Room that lines need around them to be made thicker, as a share of the span."""
_CLOSED = 0.93
"""An outline is closed once as much of the ink encloses something; the rest are whiskers."""
_BELIEVED, _DEAREST = 0.8, 3.0
"""A guess builds bridges up to such a share of closed lines, and of such a cost, as a share of the span."""
_SMALL = 7.0
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
        self._lines, self._inside = inked, np.zeros_like(inked)
        self._near = self._inside  # what lies in the inside or around it
        self.closed = 0.0

    def fill(self) -> None:
        """Close gaps, small ones first, until nearly all lines enclose something."""
        found: list[Bridge] | None = None
        built = 0
        for gap, cost in _STEPS:
            if cost and found is None:
                found = self._bridges(max(each for _, each in _STEPS) * self._span)
            wanted = [each for each in found or () if each.cost <= cost * self._span]
            self._build(wanted[built:])
            self._take(gap * self._span)
            built = len(wanted)
            if self.closed > _CLOSED:
                break

    def guess(self) -> bool:
        """Bridge gaps of nearly any width, until most lines enclose something; return whether that helped."""
        before = self.closed
        for bridge in self._bridges(_DEAREST * self._span):
            if self.closed >= _BELIEVED:
                break
            self._build([bridge])
            self._take(0)
        return self.closed > before

    def mask(self) -> BoolMask:
        """Return the inside with its lines, and the lines that hang on it."""
        if not self._inside.any():
            return self._inside
        # The lines at its edge belong to it, and so do eyes and stripes, whatever they are drawn with.
        whole = enclosed_by(self._inside | (self._lines & self._near))
        return whole | limbs(self._inked & ~whole, whole, self._span, self._width)

    def _bridges(self, most: float) -> list[Bridge]:
        """Return bridges from the ends of lines that are not inside anyway."""
        whole = enclosed_by(self._inside | (self._lines & self._near))
        ends = stroke_ends(self._inked, self._width)
        ahead = np.rint(ends.points + (self._width + 1) * ends.ways).astype(np.intp)
        column, row = np.clip(ahead, 0, np.array(whole.shape[::-1]) - 1).T
        return bridges(ends.only(~whole[row, column]), self._inked, self._span, most)

    def _build(self, wanted: list[Bridge]) -> None:
        if not wanted:
            return
        lines = self._lines.astype(np.uint8)
        for each in wanted:
            cv2.line(lines, each.start, each.end, 1)
        self._lines = lines > 0

    def _take(self, gap: float) -> None:
        """Add what is enclosed by lines made thicker by ``gap`` on either side."""
        thick = _thicker(self._lines, gap)
        fresh = enclosed_by(thick) & ~thick & ~self._inside
        if not fresh.any():
            return
        self._inside = self._inside | (_grown(fresh, self._lines, gap) if gap else fresh)
        self._near = _thicker(self._inside, self._width + 1.5)
        near = int(np.count_nonzero(self._inked & self._near))
        self.closed = near / int(np.count_nonzero(self._inked))


def _grown(seeds: BoolMask, barrier: BoolMask, reach: float) -> BoolMask:
    """Return seeds with all within ``reach`` pixels that is not behind a barrier."""
    box = around(seeds, int(reach) + 1)
    free = (~barrier[box] & _thicker(seeds[box], reach + 0.5)).astype(np.uint8)
    grown = seeds[box].astype(np.uint8)
    # Steps to the side only: a slanted line may hang together by its pixels' corners.
    step = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    for _ in range(int(np.ceil(reach * np.sqrt(2)))):
        grown = np.minimum(cv2.dilate(grown, step), free)
    whole = np.zeros_like(seeds)
    whole[box] = grown > 0
    return whole


def _thicker(marked: BoolMask, reach: float) -> BoolMask:
    """Return what is marked (H, W) and all within ``reach`` pixels of it."""
    if reach < 1:
        return marked
    if reach < _SMALL:
        along = np.arange(-int(reach), int(reach) + 1)
        disc = (np.hypot(along, along[:, None]) <= reach).astype(np.uint8)
        return np.asarray(cv2.dilate(marked.astype(np.uint8), disc) > 0)
    away = cv2.distanceTransform((~marked).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(away <= reach)
