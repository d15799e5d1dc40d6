"""Curves as evenly spaced points, shared by the effects of the hand."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.strokes.curves import lengths_along
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["begin_at", "piece", "resample", "turning"]


def resample(stroke: Stroke, step: float) -> Stroke:
    """Return the stroke with points at most ``step`` pixels apart, evenly, at least three; its ends stay.

    >>> resample(Stroke.even(np.array([[0.0, 0.0], [0.0, 4.0]]), 1.0), 1.0).points[:, 1]
    array([0., 1., 2., 3., 4.])
    """
    along = lengths_along(stroke.points)
    at = np.linspace(0, along[-1], max(3, int(np.ceil(along[-1] / step - 1e-9)) + 1))
    values = (*stroke.points.T, stroke.width, stroke.darkness)
    x, y, width, darkness = (np.interp(at, along, value) for value in values)
    return Stroke(np.stack([x, y], axis=1), width, darkness)


def piece(stroke: Stroke, start: int, stop: int) -> Stroke:
    """Return the points ``start`` to ``stop`` (not included) as a stroke."""
    part = slice(start, stop)
    return Stroke(stroke.points[part], stroke.width[part], stroke.darkness[part])


def begin_at(stroke: Stroke, index: int) -> Stroke:
    """Return a closed stroke with another point as its start and end."""

    def turn(values: Doubles) -> Doubles:
        return np.concatenate([values[index:-1], values[: index + 1]])

    return Stroke(turn(stroke.points), turn(stroke.width), turn(stroke.darkness))


def turning(points: Doubles, reach: int, closed: bool = False) -> Doubles:
    """Return how far a curve turns at each point, in radians, as seen from ``reach`` points before and after.

    At the ends of an open curve, and where points coincide, it is 0.

    >>> turning(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), 1).round(3)
    array([0.   , 1.571, 0.   ])
    """
    inner = points[:-1] if closed else points
    before, after = np.roll(inner, reach, axis=0), np.roll(inner, -reach, axis=0)
    (ax, ay), (bx, by) = (inner - before).T, (after - inner).T
    angle: Doubles = np.abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
    if closed:
        return np.append(angle, angle[0])
    angle[:reach] = 0
    angle[max(len(angle) - reach, 0) :] = 0
    return angle
