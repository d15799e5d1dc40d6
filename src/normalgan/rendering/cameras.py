"""Cameras: position around the object, framing, and projection."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles
from normalgan.ranges import Range, UnitInterval, check_ranges
from normalgan.rendering.mesh import Mesh


@dataclass(frozen=True)
class Camera:
    """A perspective or orthographic camera with a square frame, looking along its own -z axis.

    Args:
        rotation: (3, 3) world to camera; the rows are the camera's x (right), y (up) and z (to the
            viewer).
        translation: (3,) world to camera: ``p_camera = rotation @ p_world + translation``.
        perspective: whether the projection is perspective (True) or orthographic (False).
        window: (left, right, bottom, top) of the frame: in camera units if orthographic, on the plane
            z = -1 if perspective. It need not be centred on the axis.
        near: distance to the near plane, positive.
        far: distance to the far plane, positive.
    """

    rotation: Doubles
    translation: Doubles
    perspective: bool
    window: tuple[float, float, float, float]
    near: float
    far: float

    def view_matrix(self) -> Doubles:
        """Return the (4, 4) matrix from world to camera, for column vectors."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    def projection_matrix(self) -> Doubles:
        """Return the (4, 4) matrix from camera to OpenGL clip space, for column vectors.

        These are the matrices of ``glFrustum`` and ``glOrtho`` (OpenGL 2.1 specification, section 2.11.2),
        but with the window of the former on the plane z = -1 instead of the near plane.
        """
        left, right, bottom, top = self.window
        width, height, length = right - left, top - bottom, self.far - self.near
        matrix = np.zeros((4, 4))
        matrix[0, 0], matrix[1, 1] = 2 / width, 2 / height
        column = 2 if self.perspective else 3
        sign = 1 if self.perspective else -1
        matrix[0, column] = sign * (right + left) / width
        matrix[1, column] = sign * (top + bottom) / height
        if self.perspective:
            matrix[2, 2:] = -(self.far + self.near) / length, -2 * self.far * self.near / length
            matrix[3, 2] = -1
        else:
            matrix[2, 2:] = -2 / length, -(self.far + self.near) / length
            matrix[3, 3] = 1
        return matrix

    def rays(
        self, size: int, rows: slice = slice(None), columns: slice = slice(None)
    ) -> tuple[Doubles, Doubles]:
        """Return the rays through the pixel centres.

        Args:
            size: H and W of the picture.
            rows: rows of the picture to return rays for.
            columns: columns of the picture to return rays for.

        Returns:
            origins: (H, W, 3) world positions on the camera plane, with row 0 at the top of the picture.
            directions: (H, W, 3) world vectors that increase the depth by one, so that ``t`` in ``origin +
                t * direction`` is the depth of `Maps`.
        """
        left, right, bottom, top = self.window
        steps = (np.arange(size) + 0.5) / size
        x, y = (left + (right - left) * steps)[columns], (top + (bottom - top) * steps)[rows]
        across, up, back = self.rotation
        places = x[None, :, None] * across + y[:, None, None] * up
        eye = -self.translation @ self.rotation
        if self.perspective:
            return np.broadcast_to(eye, places.shape), places - back
        return places + eye, np.broadcast_to(-back, places.shape)


def look_at_origin(azimuth: float, elevation: float, roll: float) -> Doubles:
    """Return the (3, 3) rotation, world to camera, of a camera that looks at the origin.

    Args:
        azimuth: degrees from +Z towards +X; at 0, the viewer is at +Z and sees +X on the right.
        elevation: degrees above the horizon; +Y is up.
        roll: counter-clockwise rotation of the picture in degrees.

    Example:
        >>> (look_at_origin(90, 0, 0) @ [1, 0, 0]).round(6) + 0.0  # from +X, +X points at the viewer
        array([0., 0., 1.])
    """
    a, e, r = np.deg2rad([azimuth, elevation, roll])
    z = np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    x = np.array([np.cos(a), 0.0, -np.sin(a)])
    y = np.cross(z, x)
    return np.stack([np.cos(r) * x - np.sin(r) * y, np.sin(r) * x + np.cos(r) * y, z])


@dataclass(frozen=True)
class Views:
    """Random views of an object that fills the frame, with uniform distributions.

    Args:
        azimuth: range of the viewer's azimuth about +Y in degrees; 0 is at +Z, with +X on the right.
        elevation: range of the viewer's elevation above the horizon in degrees.
        roll: range of the roll of the picture in degrees, counter-clockwise positive.
        perspective: fraction of perspective views, from 0 (all orthographic) to 1.
        field_of_view: range of the angle of the object's bounding sphere in a perspective view, in
            degrees. A smaller angle means a more distant camera.
        margin: margin on each side of the object, as a fraction of the frame's side, from 0 to below 0.5.
    """

    azimuth: Annotated[tuple[float, float], Range(-360, 360)] = (0.0, 360.0)
    elevation: Annotated[tuple[float, float], Range(-90, 90)] = (-10.0, 30.0)
    roll: Annotated[tuple[float, float], Range(-180, 180)] = (-5.0, 5.0)
    perspective: UnitInterval = 0.5
    field_of_view: Annotated[tuple[float, float], Range(1, 120)] = (20.0, 50.0)
    margin: Annotated[float, Range(0, 0.5, below=True)] = 0.06

    def __post_init__(self) -> None:
        check_ranges(self)

    def camera(self, mesh: Mesh, rng: np.random.Generator) -> Camera:
        """Return a random camera that shows the whole mesh, centred, with ``margin`` on each side."""
        # Always five draws, so that one setting does not affect the draws of the others.
        azimuth, elevation, roll = (rng.uniform(*r) for r in (self.azimuth, self.elevation, self.roll))
        perspective = bool(rng.random() < self.perspective)
        field_of_view = rng.uniform(*self.field_of_view)
        rotation = look_at_origin(azimuth, elevation, roll)
        return framed(mesh.vertices, rotation, field_of_view if perspective else None, self.margin)


def framed(
    vertices: NDArray[np.floating], rotation: Doubles, field_of_view: float | None, margin: float
) -> Camera:
    """Return the camera with a given rotation and a frame that just contains the projected vertices.

    Args:
        vertices: (V, 3) world positions around the origin.
        rotation: (3, 3) world to camera.
        field_of_view: angle in degrees of the bounding sphere in a perspective view; None for
            an orthographic one.
        margin: margin on each side, as a fraction of the frame's side.
    """
    turned = vertices.astype(np.float64) @ rotation.T
    radius = float(np.linalg.norm(turned, axis=1).max())
    perspective = field_of_view is not None
    distance = radius / np.sin(np.deg2rad(field_of_view) / 2) if field_of_view is not None else 2 * radius
    seen = turned[:, :2] / (distance - turned[:, 2:]) if perspective else turned[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    unit = radius / distance if perspective else radius
    # A line viewed end-on has no extent, so the frame spans at least a hundredth of the object.
    side = max(float((high - low).max()), 0.01 * unit) / (1 - 2 * margin)
    (x, y), half = (low + high) / 2, side / 2
    window = (float(x - half), float(x + half), float(y - half), float(y + half))
    # 1 % of slack, so that rounding cannot push the nearest or farthest point out of the depth range.
    near, far = 0.99 * (distance - radius), 1.01 * (distance + radius)
    return Camera(rotation, np.array([0.0, 0.0, -distance]), perspective, window, float(near), float(far))


def project(camera: Camera, points: Doubles, size: int) -> tuple[Doubles, Doubles]:
    """Return the positions (N, 2) of points (N, 3) in a sketch of ``size`` pixels, and their depths (N,).

    Positions are in pixels, right and down, as in `Stroke`, and depths as in `Maps`. All points must be in
    front of the camera.

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
    """Return the unit vectors (N, 3) from points (N, 3) to the viewer, all the same if orthographic."""
    if not camera.perspective:
        return np.broadcast_to(camera.rotation[2], points.shape)
    away = -camera.translation @ camera.rotation - points
    unit: Doubles = away / np.linalg.norm(away, axis=1, keepdims=True)
    return unit
