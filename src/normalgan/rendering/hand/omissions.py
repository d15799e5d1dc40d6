"""Omissions: missing strokes, and parts of strokes without ink."""

from collections.abc import Sequence

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.hand.curves import piece
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["forget", "skip_parts"]

_OUTLINE, _INSIDE = 0.05, 0.4  # of the side; strokes this long are forgotten e times less often
_GAP = 0.05  # of the side; mean length of a skipped part
_SHORTEST = 0.012  # of the side; shorter remains of a stroke are skipped too


def forget(
    strokes: Sequence[Stroke], interior: Doubles, chance: float, side: float, rng: np.random.Generator
) -> list[Stroke]:
    """Return the strokes without some; inner and short ones are missed more often.

    The longest always stays, so that no drawing is empty.

    Args:
        strokes: the drawing.
        interior: the share of each stroke that lies away from the silhouette.
        chance: that a very short stroke is missed.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    if not strokes:
        return []
    length = np.array([stroke.length for stroke in strokes])
    missed = chance * np.exp(-length / side / (_OUTLINE + (_INSIDE - _OUTLINE) * interior))
    kept = rng.random(len(strokes)) >= missed
    kept[length.argmax()] = True
    return [stroke for stroke, keep in zip(strokes, kept, strict=True) if keep]


def skip_parts(
    stroke: Stroke, parts: float, step: float, side: float, rng: np.random.Generator
) -> list[Stroke]:
    """Return the drawn parts of a stroke after leaving out some.

    Args:
        stroke: with points ``step`` pixels apart.
        parts: how many are expected on the length of a side.
        step: pixels.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    count = len(stroke.points)
    missing = rng.poisson(parts * (count - 1) * step / side)
    drawn = np.ones(count, bool)
    for middle, share in zip(rng.random(missing), rng.exponential(_GAP, missing), strict=True):
        half = min(share * side / step, 0.3 * count) / 2
        drawn[max(0, round(middle * count - half)) : round(middle * count + half)] = False
    if drawn.all():
        return [stroke]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], drawn, [False]]).astype(int))).reshape(-1, 2)
    longest = edges[np.argmax(edges[:, 1] - edges[:, 0])]
    enough = max(3, round(_SHORTEST * side / step))
    left = [(start, stop) for start, stop in edges if stop - start >= enough]
    return [piece(stroke, start, stop) for start, stop in left or [longest] if stop - start > 1] or [stroke]
