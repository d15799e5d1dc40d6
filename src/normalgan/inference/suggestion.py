"""Suggestion: find the points of a normal map where a hint would help most."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.reading.picture import fitted_within, resize
from normalgan.inference.regions import depth_of, extent_of
from normalgan.normals import normalize

_SIDE = 256
"""Maximum longer side in pixels at which points are searched."""
_RIM = 0.02
"""Width of the rim in which the outline determines the normal, as a fraction of the object's extent."""

_INKED = 0.1
"""Minimum ink of a pixel of the reduced map that counts as part of a line."""


@dataclass(frozen=True)
class Point:
    """A suggested position for a hint.

    Args:
        x: pixels from the left.
        y: pixels from the top.
        normal: the predicted normal.
        gain: expected benefit of a hint, in [0, 1], relative to the best point of the map.
    """

    x: float
    y: float
    normal: tuple[float, float, float]
    gain: float


def suggest(
    normals: Floats,
    mask: NDArray[np.bool_],
    confidence: Floats | None,
    taken: Floats,
    count: int,
    lines: NDArray[np.bool_] | None = None,
) -> list[Point]:
    """Return at most ``count`` points, the best first.

    A hint helps where the model is uncertain, and where the surface is curved, because a small error there
    affects many normals. It also helps its surroundings, so the gain is summed over a hint's reach. After the
    best point is chosen, the gain around it is reduced and points within its reach are excluded. The points
    therefore have a blue-noise distribution, like Mitchell's best candidates.

    Args:
        normals: (H, W, 3), predicted unit normals.
        mask: (H, W), the object.
        confidence: (H, W), the model's κ ≥ 0; None uses only the curvature.
        taken: (K, 2), x and y of the existing hints in pixels.
        count: maximum number of points.
        lines: (H, W), mask of the lines, or None. Two surfaces meet at a line, so the normal on it is
            ambiguous; points avoid lines where possible.

    References:
        Mitchell 1991, "Spectrally Optimal Sampling for Distribution Ray Tracing".

    Example:
        The ridge in the middle of a roof gains more than its flat slopes:

        >>> roof = np.zeros((32, 32, 3), np.float32)
        >>> roof[:, :16], roof[:, 16:] = (-0.6, 0, 0.8), (0.6, 0, 0.8)
        >>> best = suggest(roof, np.ones((32, 32), bool), None, np.empty((0, 2), np.float32), 1)[0]
        >>> 13 < best.x < 19
        True
    """
    if not mask.any():
        return []
    shape = fitted_within((mask.shape[0], mask.shape[1]), _SIDE)
    cover = resize(mask.astype(np.float32), shape)
    # A thin thread never covers half a pixel of the reduced map.
    small = cover > (0.5 if cover.max() > 0.5 else 0)
    step = np.array([shape[1] / mask.shape[1], shape[0] / mask.shape[0]], np.float32)
    area = float(small.sum())
    reach = max(0.55 * np.sqrt(area / (count + len(taken))), 2.0)
    depth = _depth(small)
    counts = np.clip(depth / 2, 0, 1).astype(np.float32)  # pixels near the outline count less
    bent = _peaked(_bending(resize(normals, shape), small) * counts, reach / 2)
    gain = bent.copy()
    if confidence is not None:
        gain = 0.7 * _peaked(uncertainty(resize(confidence, shape)) * counts, reach / 2) + 0.3 * bent
    free: BoolMask = np.asarray(depth > min(1, 0.8 * float(depth.max())))
    if lines is not None:
        off = _depth(resize(lines.astype(np.float32), shape) < _INKED)
        if (free & (off > 1)).any():
            free &= off > 1
    rows, columns = np.mgrid[: shape[0], : shape[1]] + 0.5

    def take(x: float, y: float) -> None:
        away = np.hypot(columns - x, rows - y)
        free[away < reach] = False
        gain[:] *= 1 - np.exp(-((away / reach) ** 2) / 4)  # a hint provides part of the gain around it

    for x, y in taken * step:
        take(x, y)
    points: list[Point] = []
    while free.any() and len(points) < count:
        row, column = np.unravel_index(np.argmax(np.where(free, gain, -1)), shape)
        points.append(_point(row, column, step, normals, mask, float(gain[row, column])))
        take(column + 0.5, row + 0.5)
    return points


def uncertainty(confidence: Floats) -> Floats:
    """Return the expected angular error as a fraction of a right angle.

    For the density exp(-κ θ) on the sphere, the normalising integral is 2π (1 + exp(-π κ)) / (κ² + 1). The
    mean angle is minus the derivative of its logarithm with respect to κ: 2κ / (κ² + 1) + π / (exp(π κ) + 1).

    References:
        Bae, Budvytis, Cipolla 2021, "Estimating and Exploiting the Aleatoric Uncertainty in Surface Normal
        Estimation", equation 5.

    >>> uncertainty(np.array([0.0, 200.0], np.float32)).astype(float).round(3).tolist()
    [1.0, 0.006]
    """
    kappa = np.clip(confidence.astype(np.float64), 0, 1e6)
    angle = 2 * kappa / (kappa**2 + 1) + np.pi / (np.exp(np.minimum(np.pi * kappa, 700)) + 1)
    return (angle / (np.pi / 2)).astype(np.float32)


def _bending(normals: Floats, mask: NDArray[np.bool_]) -> Floats:
    """Return the change (H, W) of normals between neighbouring pixels, not counting the mask's edge."""
    squares = np.zeros(mask.shape, np.float32)
    for before, after in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        both = mask[before] & mask[after]
        change = np.where(both, np.square(normals[after] - normals[before]).sum(-1), 0)
        squares[before] += change / 2
        squares[after] += change / 2
    return np.sqrt(squares)


def _peaked(values: Floats, reach: float) -> Floats:
    """Return values blurred over a reach and normalised to a maximum of 1."""
    around = cv2.GaussianBlur(values.astype(np.float32), (0, 0), reach)
    return np.asarray(around / max(float(around.max()), 1e-6), np.float32)


def _depth(mask: NDArray[np.bool_]) -> Floats:
    """Return the distance to the object's edge in units of the rim's width; 0 off the object."""
    return np.asarray(depth_of(mask, 3) / max(_RIM * extent_of(mask), 1.5), np.float32)


def _point(
    row: np.intp, column: np.intp, step: Floats, normals: Floats, mask: NDArray[np.bool_], gain: float
) -> Point:
    """Return a pixel of the reduced map as the nearest point on the object in the full map."""
    x, y = (column + 0.5) / step[0], (row + 0.5) / step[1]
    at = min(int(y), mask.shape[0] - 1), min(int(x), mask.shape[1] - 1)
    if not mask[at]:
        rows, columns = np.nonzero(mask)
        nearest = np.argmin(np.hypot(columns + 0.5 - x, rows + 0.5 - y))
        at = int(rows[nearest]), int(columns[nearest])
    normal = normalize(normals[at][None])[0]
    return Point(at[1] + 0.5, at[0] + 0.5, tuple(normal.astype(float).tolist()), min(gain, 1.0))
