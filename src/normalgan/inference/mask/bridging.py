"""Bridging: the straight lines that would close the gaps of an outline, the likeliest first."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.mask.stroke_ends import Ends

__all__ = ["Bridge", "bridges"]

_FAN = np.deg2rad(np.arange(-45, 46, 15))
"""Ways in which a line may go on to meet another."""
_ONTO = 1.3
"""How much likelier it is that an end goes on to an end than to the middle of a line."""
_NEAR = 0.2
"""Greatest cost of a bridge to the middle of a line, as a share of the drawing's span."""
_WAYS, _MOST = 3, 400


@dataclass(frozen=True)
class Bridge:
    """A straight line across a gap.

    Args:
        start: x and y in whole pixels.
        end: x and y in whole pixels.
        cost: its length in pixels, up to five times as much where lines would have to turn for it.
    """

    start: tuple[int, int]
    end: tuple[int, int]
    cost: float


def bridges(ends: Ends, inked: BoolMask, span: float, most: float) -> list[Bridge]:
    """Return bridges between the ends of lines, and from ends to lines, the cheapest first.

    An end has up to three: the cheapest way on need not be the right one.

    Args:
        ends: of the lines.
        inked: (H, W), the lines.
        span: longer side of what they cover, in pixels.
        most: greatest cost.

    Returns:
        Bridges; none at all if there are hundreds of ends, as hair and hatching have, of which each would
        find a partner.
    """
    if len(ends) > _MOST:
        return []
    built = [0] * len(ends)
    found = []
    candidates = [*_to_ends(ends, most), *_to_lines(ends, inked, min(_NEAR * span, most))]
    for cost, own, other, goal in sorted(candidates):
        both = [own] if other < 0 else [own, other]
        start = ends.points[own]
        if max(built[each] for each in both) >= _WAYS:
            continue
        if other >= 0 and _crosses(start, ends.points[other], inked, ends.width):
            continue
        for each in both:
            built[each] += 1
        found.append(Bridge((int(start[0]), int(start[1])), goal, cost))
    return found


_Candidate = tuple[float, int, int, tuple[int, int]]


def _to_ends(ends: Ends, most: float) -> Iterator[_Candidate]:
    """Yield the cost, the first end, the second one and where that lies, of what is not too dear."""
    away = ends.points[None] - ends.points[:, None]
    length = np.hypot(away[..., 0], away[..., 1])
    ahead = (away * ends.ways[:, None]).sum(-1) / np.maximum(length, 1e-6)
    cost = length * (3 - ahead - ahead.T)
    for own, other in zip(*np.nonzero(np.triu(cost <= most, 1)), strict=True):
        x, y = ends.points[other]
        yield float(cost[own, other]), int(own), int(other), (int(x), int(y))


def _to_lines(ends: Ends, inked: BoolMask, most: float) -> Iterator[_Candidate]:
    """Yield the cost, the end, -1 and where the line is that it would meet first by each way."""
    reach = int(most / _ONTO)
    if not len(ends) or reach < 2:
        return
    cosine, sine = np.cos(_FAN), np.sin(_FAN)
    turned = np.stack([
        ends.ways[:, :1] * cosine - ends.ways[:, 1:] * sine,
        ends.ways[:, :1] * sine + ends.ways[:, 1:] * cosine,
    ])  # fmt: skip
    steps = np.arange(2, reach + 1)
    x = np.rint(ends.points[:, 0, None, None] + turned[0][..., None] * steps).astype(np.intp)
    y = np.rint(ends.points[:, 1, None, None] + turned[1][..., None] * steps).astype(np.intp)
    inside = (x >= 0) & (y >= 0) & (x < inked.shape[1]) & (y < inked.shape[0])
    met = inside & inked[np.where(inside, y, 0), np.where(inside, x, 0)]
    first = met.argmax(-1)
    cost = _ONTO * steps[first] * (2 - cosine)
    for own, way in zip(*np.nonzero(met.any(-1) & (cost <= most)), strict=True):
        at = first[own, way]
        yield float(cost[own, way]), int(own), -1, (int(x[own, way, at]), int(y[own, way, at]))


def _crosses(start: Floats, end: Floats, inked: BoolMask, width: float) -> bool:
    """Return whether there is a line between two ends, which themselves are of lines so wide."""
    count = int(np.abs(end - start).max())
    beside = int(width) + 2
    along = np.linspace(0, 1, count + 1)[beside:-beside, None]
    x, y = np.rint(start + along * (end - start)).astype(np.intp).T
    return bool(inked[y, x].any())
