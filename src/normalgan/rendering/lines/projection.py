"""Projection of points to the sketch, their depth, and the direction to the eye."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.cameras import Camera

__all__ = ["project", "towards_eye"]


def project(camera: Camera, points: Doubles, size: int) -> tuple[Doubles, Doubles]:
    """Return where points (N, 3) lie in a sketch of ``size`` pixels, (N, 2), and their depths (N,).

    Right and down in pixels as in `Stroke`; depth as in `Maps`. All points must lie in front of the eye.

    >>> from normalgan.rendering.cameras import framed, look_at_origin
    >>> camera = framed(np.eye(3), look_at_origin(0, 0, 0), None, 0.0)
    >>> project(camera, np.eye(3), 10)[0].round(6) + 0.0
    array([[10., 10.],
           [ 0.,  0.],
           [ 0., 10.]])
    """
    seen = points @ camera.rotation.T + camera.translation
    depth = -seen[:, 2]
    left, right, bottom, top = camera.window
    at = seen[:, :2] / depth[:, None] if camera.perspective else seen[:, :2]
    place = (at - [left, top]) / [right - left, bottom - top] * size
    return place, depth


def towards_eye(camera: Camera, points: Doubles) -> Doubles:
    """Return the unit vectors (N, 3) from points (N, 3) to the eye; all the same in an orthographic view."""
    if not camera.perspective:
        return np.broadcast_to(camera.rotation[2], points.shape)
    away = -camera.translation @ camera.rotation - points
    unit: Doubles = away / np.linalg.norm(away, axis=1, keepdims=True)
    return unit
