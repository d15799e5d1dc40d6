"""Repeats: strokes that are drawn a second time."""

import numpy as np

from normalgan.rendering.hand.curves import piece
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["second_pass"]

_LEAST = 0.4  # of the stroke: a second pass is no shorter
_OFFSET = 0.005  # of the side: how far it lies beside the first (standard deviation)


def second_pass(stroke: Stroke, side: float, rng: np.random.Generator) -> Stroke:
    """Return a second stroke close to the first, over at least two fifths of it.

    Args:
        stroke: the first pass.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    count = len(stroke.points)
    kept = min(max(3, round(rng.uniform(_LEAST, 1) * count)), count)
    start = int(rng.integers(count - kept + 1))
    part = piece(stroke, start, start + kept)
    return Stroke(part.points + rng.normal(0, _OFFSET * side, 2), part.width, part.darkness)
