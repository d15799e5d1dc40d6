"""Ends: strokes that stop short or overshoot."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.hand.curves import piece
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["miss_ends"]

_MOST = 0.25  # of the stroke; the longest error of an end
_LOOK = 6  # points over which the direction and the bend of an end are taken
_BEND = np.deg2rad(40)  # the most that an overshoot turns


def miss_ends(stroke: Stroke, overshoot: float, gap: float, step: float, rng: np.random.Generator) -> Stroke:
    """Return the stroke with each end lengthened or shortened, with equal chance, by an exponential length.

    Args:
        stroke: with points ``step`` pixels apart.
        overshoot: mean length of an overshoot in pixels.
        gap: mean length of a gap in pixels.
        step: pixels.
        rng: source of randomness.
    """
    most = _MOST * (len(stroke.points) - 1)
    for _ in range(2):  # the end, and then, turned round, the beginning
        beyond, lengths = rng.random() < 0.5, rng.exponential([overshoot, gap]) / step
        change = round(min(lengths[0 if beyond else 1], most))
        if beyond and change:
            stroke = _longer(stroke, change, step)
        elif change and len(stroke.points) - change > 2:
            stroke = piece(stroke, 0, len(stroke.points) - change)
        stroke = Stroke(stroke.points[::-1], stroke.width[::-1], stroke.darkness[::-1])
    return stroke


def _longer(stroke: Stroke, count: int, step: float) -> Stroke:
    """Return the stroke with ``count`` more points at its end, which continue its direction and curve."""
    look = min(_LOOK, (len(stroke.points) - 1) // 2)
    near, middle, far = (stroke.points[-1 - k * look] for k in range(3))
    heading, earlier = _angle(near - middle), _angle(middle - far)
    bend = (heading - earlier + np.pi) % (2 * np.pi) - np.pi
    rate = np.clip(bend / look, -_BEND / count, _BEND / count)
    angles = heading + rate * (look / 2 + np.arange(1, count + 1))
    ahead = near + step * np.cumsum(np.stack([np.cos(angles), np.sin(angles)], axis=1), axis=0)
    return Stroke(
        np.concatenate([stroke.points, ahead]),
        np.concatenate([stroke.width, np.full(count, stroke.width[-1])]),
        np.concatenate([stroke.darkness, np.full(count, stroke.darkness[-1])]),
    )


def _angle(vector: Doubles) -> float:
    return float(np.arctan2(vector[1], vector[0]))
