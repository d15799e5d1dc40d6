"""Runs: the parts of a path that are strong and long enough to draw."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.strokes.curves import lengths_along

__all__ = ["worthy_runs"]


def worthy_runs(
    points: Doubles, strength: Doubles, least: float, seed: float, bridge: float, shortest: float
) -> list[slice]:
    """Return the stretches of a path to draw, of at least two points each.

    A stretch has a strength of at least ``least`` but for gaps up to ``bridge`` long, reaches ``seed``
    somewhere, and is at least ``shortest`` long.

    >>> points = np.stack([np.arange(8.0), np.zeros(8)], axis=1)
    >>> strength = np.array([0, 2, 2, 0, 3, 2, 0, 2.0])
    >>> worthy_runs(points, strength, least=1, seed=3, bridge=2, shortest=2)
    [slice(1, 8, None)]
    >>> worthy_runs(points, strength, least=1, seed=3, bridge=1, shortest=1)
    [slice(4, 6, None)]

    Args:
        points: (P, 2) of the path.
        strength: (P,).
        least: strength down to which a stretch continues.
        seed: strength that a stretch must reach.
        bridge: in units of the points.
        shortest: in units of the points, along the path.
    """
    along = lengths_along(points)
    good = np.flatnonzero(strength >= least)
    if not len(good):
        return []
    breaks = np.flatnonzero((np.diff(good) > 1) & (np.diff(along[good]) > bridge))
    starts = good[np.concatenate([[0], breaks + 1])]
    stops = good[np.concatenate([breaks, [len(good) - 1]])]
    return [
        slice(int(start), int(stop) + 1)
        for start, stop in zip(starts, stops, strict=True)
        if stop > start
        and strength[start : stop + 1].max() >= seed
        and along[stop] - along[start] >= shortest
    ]
