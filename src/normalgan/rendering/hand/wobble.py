"""Wobble: smooth deviations of a line, from slow drift to tremor, and rounded detail."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from normalgan.arrays import Doubles
from normalgan.rendering.hand.noise import smooth_noise
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["DRIFT", "TREMOR", "WOBBLE", "round_off", "stray"]

DRIFT, WOBBLE, TREMOR = 0.6, 0.14, 0.025
"""The wavelengths as fractions of the frame's side: aim, arm and fingers."""


def stray(
    strokes: Sequence[Stroke],
    amplitudes: Sequence[float],
    step: float,
    side: float,
    rng: np.random.Generator,
) -> list[Stroke]:
    """Return strokes whose points stray smoothly, independently of one another, ends included.

    Args:
        strokes: with points ``step`` pixels apart.
        amplitudes: amplitudes of drift, wobble and tremor along each axis, in pixels (standard deviations).
        step: pixels.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    counts = [len(stroke.points) for stroke in strokes]
    if not counts:
        return []
    shift = np.zeros((sum(counts), 2))
    for amplitude, wavelength, source in zip(amplitudes, (DRIFT, WOBBLE, TREMOR), rng.spawn(3), strict=True):
        if amplitude:
            shift += amplitude * smooth_noise(counts, step, wavelength * side, 2, source)
    parts = np.split(shift, np.cumsum(counts)[:-1])
    return [
        Stroke(stroke.points + part, stroke.width, stroke.darkness)
        for stroke, part in zip(strokes, parts, strict=True)
    ]


def round_off(stroke: Stroke, deviation: float) -> Stroke:
    """Return the stroke with its detail rounded off, the ends of an open one in place, and hardly shrunk.

    The filter is 2 G − G * G for a Gaussian G, which leaves curves wider than it nearly as they are: what
    smoothing took away is smoothed and put back ("twicing", Tukey, Exploratory Data Analysis, 1977).

    Args:
        stroke: with evenly spaced points.
        deviation: deviation of the Gaussian, in points.
    """
    points = stroke.points
    pad = min(int(8 * deviation) + 1, len(points) - 1)
    if stroke.closed:
        before, after = points[-1 - pad : -1], points[1 : 1 + pad]
    else:  # continued by its rotation about each end, the curve is smooth and keeps its ends
        before, after = 2 * points[0] - points[pad:0:-1], 2 * points[-1] - points[-2 : -pad - 2 : -1]
    once: Doubles = gaussian_filter1d(np.concatenate([before, points, after]), deviation, axis=0)
    smooth = (2 * once - gaussian_filter1d(once, deviation, axis=0))[pad : pad + len(points)]
    smooth[-1] = smooth[0] if stroke.closed else points[-1]
    if not stroke.closed:
        smooth[0] = points[0]
    return Stroke(smooth, stroke.width, stroke.darkness)
