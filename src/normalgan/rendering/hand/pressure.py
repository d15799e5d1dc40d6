"""Pressure: width and darkness along a stroke, as the pen is set down, hurried along and lifted."""

from collections.abc import Sequence

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.hand.curves import turning
from normalgan.rendering.hand.noise import smooth_noise
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["press"]

_WAVELENGTH = 0.35  # of the side; wavelength of the pressure
_TAPER = 0.07  # of the side; length over which the pen is set down or lifted, on a long stroke
_START = 0.5  # the taper where the pen is set down, as a share of that where it is lifted
_TIGHT = np.deg2rad(40)  # a turn at which the hand is slowest
_LOOK = 0.012  # of the side; distance before and after a point over which its turn is measured


def press(
    strokes: Sequence[Stroke],
    pressure: float,
    fade: float,
    taper: float,
    slowness: float,
    step: float,
    side: float,
    rng: np.random.Generator,
) -> list[Stroke]:
    """Return strokes whose width and darkness vary along them.

    Args:
        strokes: with points ``step`` pixels apart.
        pressure: deviation of the logarithm of the width, along strokes and among them.
        fade: deviation of the logarithm of the darkness where pressure is low; ink is never darker than 1.
        taper: share by which the line thins towards the end where the pen is lifted.
        slowness: share by which the line widens in tight turns, where the hand is slow.
        step: pixels.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    counts = [len(stroke.points) for stroke in strokes]
    if not counts:
        return []
    along, own = rng.spawn(2)
    force = 0.92 * smooth_noise(counts, step, _WAVELENGTH * side, 1, along)[:, 0]
    force += 0.4 * np.repeat(own.standard_normal(len(counts)), counts)  # 0.92² + 0.4² = 1
    reach = max(1, round(_LOOK * side / step))
    pressed = []
    for stroke, f in zip(strokes, np.split(force, np.cumsum(counts)[:-1]), strict=True):
        slow = np.clip(turning(stroke.points, reach) / _TIGHT, 0, 1)
        factor = np.exp(pressure * f) * (1 + slowness * slow) * _lifted(len(f), taper, _TAPER * side / step)
        darkness = np.minimum(stroke.darkness, stroke.darkness * np.exp(fade * f))
        pressed.append(Stroke(stroke.points, stroke.width * factor, darkness))
    return pressed


def _lifted(count: int, taper: float, reach: float) -> Doubles:
    """Return the factor by which a stroke of ``count`` points is narrower towards its ends."""
    reach = max(1.0, min(reach, 0.4 * count))
    index = np.arange(count)
    start, end = (np.clip(distance / reach, 0, 1) for distance in (index, count - 1 - index))
    factor: Doubles = (1 - _START * taper * (1 - start) ** 2) * (1 - taper * (1 - end) ** 2)
    return factor
