"""Curves: smoothing polylines and setting their points at equal distances."""

import numpy as np

from normalgan.rendering.strokes.stroke import Doubles


def smooth(path: Doubles, sigma: float) -> Doubles:
    """Return a polyline smoothed by a Gaussian over its points; the ends of an open one stay.

    Args:
        path: (P, 2); closed if the last point is the first.
        sigma: standard deviation in points.

    >>> stairs = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 2.0]])
    >>> smooth(stairs, 1.0)[:, 0].round(1)  # straighter, from corner to corner
    array([0. , 0.7, 1.2, 1.7, 2. ])
    """
    reach = min(int(np.ceil(3 * sigma)), len(path) - 1)
    if reach < 1:
        return path
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    along = path[:, 0] + 1j * path[:, 1]  # both coordinates in one go
    if _closed(path):
        ring = along[:-1]
        padded = np.concatenate([ring[-reach:], ring, ring[:reach]])
        done = np.convolve(padded, kernel, "valid")
        done = np.append(done, done[0])
    else:
        # Turned half about each end, the line goes on as it came: the ends stay, and nothing shrinks.
        before, after = 2 * along[0] - along[reach:0:-1], 2 * along[-1] - along[-2 : -reach - 2 : -1]
        done = np.convolve(np.concatenate([before, along, after]), kernel, "valid")
    return np.stack([done.real, done.imag], axis=1)


def settle(path: Doubles, sigma: float, slack: float, rounds: int = 4) -> Doubles:
    """Return the polyline smoothed, but no point farther than ``slack`` from where it was, in x and in y.

    Points known only to lie on a grid make stairs. Smoothed and put back within their grid cell a few
    times over, they settle on a smooth curve through all the cells, sharp corners included.

    Args:
        path: (P, 2).
        sigma: standard deviation of the smoothing in points.
        slack: half a cell.
        rounds: how often.
    """
    settled = path
    for _ in range(rounds):
        settled = path + np.clip(smooth(settled, sigma) - path, -slack, slack)
    return smooth(settled, sigma / 2)


def resample(path: Doubles, spacing: float) -> Doubles:
    """Return points on a polyline at equal distances of about ``spacing``, the first and last its own.

    >>> resample(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]]), 1.0).tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]
    """
    steps = np.hypot(*np.diff(path, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    # A closed line needs three sides to be one.
    count = max(round(along[-1] / spacing), 3 if _closed(path) else 1)
    wanted = np.linspace(0, along[-1], count + 1)
    spaced = np.stack([np.interp(wanted, along, path[:, k]) for k in (0, 1)], axis=1)
    spaced[[0, -1]] = path[[0, -1]]
    return spaced


def _closed(path: Doubles) -> bool:
    return len(path) > 2 and bool((path[0] == path[-1]).all())
