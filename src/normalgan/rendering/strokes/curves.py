"""Curves: smoothing and resampling of polylines."""

import numpy as np

from normalgan.arrays import Doubles

SPACING = 1.0
"""Distance between the points of a stroke, in pixels of the sketch."""


def smooth(path: Doubles, sigma: float) -> Doubles:
    """Return a smoothed polyline; an open polyline keeps its ends.

    The kernel is a Gaussian times ``(3 - x²) / 2``. Its second moment vanishes, so arcs keep their radius,
    which a plain Gaussian would shrink (Wand and Schucany, "Gaussian-based kernels", Canadian Journal of
    Statistics 18(3), 1990).

    Args:
        path: (P, 2) points; the path is closed if the last point equals the first.
        sigma: standard deviation of the Gaussian, in points.

    >>> stairs = np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [3.0, 2.0], [3.0, 3.0]])
    >>> smooth(stairs, 1.0).round(1).tolist()
    [[1.0, 1.0], [1.8, 1.2], [2.3, 1.7], [2.8, 2.2], [3.0, 3.0]]
    """
    reach = min(int(np.ceil(3.5 * sigma)), len(path) - 1)
    if reach < 1:
        return path
    x = np.arange(-reach, reach + 1) / sigma
    kernel = np.exp(-0.5 * x * x) * (3 - x * x)
    kernel /= kernel.sum()
    along = path[:, 0] + 1j * path[:, 1]  # both coordinates at once
    if _closed(path):
        ring = along[:-1]
        padded = np.concatenate([ring[-reach:], ring, ring[:reach]])
        done = np.convolve(padded, kernel, "valid")
        done = np.append(done, done[0])
    else:
        # Extended by its point reflection at each end, the line keeps its ends and does not shrink.
        before, after = 2 * along[0] - along[reach:0:-1], 2 * along[-1] - along[-2 : -reach - 2 : -1]
        done = np.convolve(np.concatenate([before, along, after]), kernel, "valid")
    return np.stack([done.real, done.imag], axis=1)


def settle(path: Doubles, sigma: float, slack: float) -> Doubles:
    """Return a smoothed polyline with points that move by at most ``slack`` in x and in y.

    Use this for points on a grid, which form stairs. Sharp corners keep their positions.

    Args:
        path: (P, 2) points.
        sigma: standard deviation, as for `smooth`.
        slack: half of the grid's spacing.
    """
    return smooth(path + np.clip(smooth(path, sigma) - path, -slack, slack), sigma / 3)


def resample(path: Doubles, spacing: float) -> Doubles:
    """Return equidistant points on a polyline with a spacing of about ``spacing``, including both ends.

    >>> resample(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]]), 1.0).tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]
    """
    along = lengths_along(path)
    # A closed line needs at least three sides.
    count = max(round(along[-1] / spacing), 3 if _closed(path) else 1)
    wanted = np.linspace(0, along[-1], count + 1)
    spaced = np.stack([np.interp(wanted, along, path[:, k]) for k in (0, 1)], axis=1)
    spaced[[0, -1]] = path[[0, -1]]
    return spaced


def lengths_along(path: Doubles) -> Doubles:
    """Return the arc length (P,) of each point along a polyline (P, 2)."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])


def _closed(path: Doubles) -> bool:
    return len(path) > 2 and bool((path[0] == path[-1]).all())
