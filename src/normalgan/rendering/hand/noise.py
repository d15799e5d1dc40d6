"""Smooth noise along strokes."""

from collections.abc import Sequence

import numpy as np

from normalgan.arrays import Doubles

__all__ = ["smooth_noise", "spline_weights"]

_APART = 4  # knots between strokes, so that they share none: a cubic spans four
_SPREAD = np.sqrt(0.479)  # of a cubic B-spline with unit normal coefficients, averaged over a cell


def spline_weights(at: Doubles) -> Doubles:
    """Return the weights (N, 4) of a uniform cubic B-spline's coefficients at fractions ``at`` of a cell.

    >>> spline_weights(np.array([0.0])).round(3)
    array([[0.167, 0.667, 0.167, 0.   ]])
    """
    rest = 1 - at
    second = 2 / 3 - at * at * (1 - at / 2)
    third = 2 / 3 - rest * rest * (1 - rest / 2)
    return np.stack([rest**3 / 6, second, third, at**3 / 6], axis=-1)


def smooth_noise(
    counts: Sequence[int], step: float, wavelength: float, channels: int, rng: np.random.Generator
) -> Doubles:
    """Return noise of mean 0 and deviation 1 along strokes laid end to end, (sum of counts, channels).

    A uniform cubic B-spline with normal coefficients, two to a wavelength: its second derivative is
    continuous, and strokes and channels are independent.

    Args:
        counts: points of each stroke.
        step: distance between points.
        wavelength: in the unit of ``step``.
        channels: how many noises.
        rng: source of randomness.
    """
    sizes = np.asarray(counts)
    rate = 2 * step / wavelength
    knots = np.floor((sizes - 1) * rate).astype(int) + _APART
    starts, firsts = np.cumsum(knots) - knots, np.cumsum(sizes) - sizes
    at = np.repeat(starts, sizes) + (np.arange(sizes.sum()) - np.repeat(firsts, sizes)) * rate
    cell = np.floor(at).astype(int)
    coefficients = rng.standard_normal((int(knots.sum()), channels)) / _SPREAD
    weights = spline_weights(at - cell)
    return np.asarray(sum(weights[:, k, None] * coefficients[cell + k] for k in range(4)))
