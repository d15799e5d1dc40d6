"""Registration: the camera that aligns a mesh with a drawing, from a projection matrix."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import rq

from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.rendering.cameras import Camera
from normalgan.rendering.loading import read_triangles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile, place

__all__ = ["CREASE_ANGLE", "PlacedMesh", "camera_of", "read_placed_mesh"]

CREASE_ANGLE = 40.0
"""Edges sharper than this, in degrees, stay hard: most objects that people were asked to draw have them."""
_SKEWED = 0.03
"""A camera whose axes are farther from right angles, or an orthographic one whose axes differ more in scale,
does not turn normals into normals."""


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh ready to render, and where it lay in its file.

    Args:
        mesh: centred and of unit radius, as all are.
        to_file: (4, 4) from there to the coordinates of the file.
    """

    mesh: Mesh
    to_file: Doubles


def read_placed_mesh(path: Path) -> PlacedMesh:
    """Return the mesh in a file, and its transform back to the file's coordinates.

    Raises:
        InputError: if it cannot be read or holds no surface.
    """
    file = MeshFile(str(path), crease_angle=CREASE_ANGLE)
    return PlacedMesh(*place(file.name, file, *read_triangles(path)))


def camera_of(projection: Doubles, placed: PlacedMesh, side: int) -> Camera:
    """Return the camera that shows a mesh on a square drawing as a projection does.

    A projection K [R | t] is taken apart by an RQ decomposition (Hartley and Zisserman, "Multiple View
    Geometry", 2nd edition, section 6.2.4); one whose last row is 0 0 0 w is orthographic.

    Args:
        projection: (3, 4) from the mesh file's coordinates, homogeneous, to pixels of the drawing, x to the
            right and y downwards from the upper left corner; of any length and sign.
        placed: the mesh.
        side: side of the drawing in pixels.

    Raises:
        InputError: if no camera fits: it is singular, skewed, a mirror, or stands in the mesh.
    """
    matrix = projection @ placed.to_file
    if not np.isfinite(matrix).all() or np.linalg.norm(matrix[:, :3]) == 0:
        raise InputError(
            "its projection must hold finite numbers, and its first three columns must not all be 0."
        )
    perspective = np.linalg.norm(matrix[2, :3]) > 1e-9 * np.linalg.norm(matrix[:2, :3])
    return _perspective(matrix, placed, side) if perspective else _orthographic(matrix, placed, side)


def _perspective(matrix: Doubles, placed: PlacedMesh, side: int) -> Camera:
    vertices = placed.mesh.vertices.astype(np.float64)
    if matrix[2, 3] < 0:  # the mesh's centre is the origin, in front of the eye
        matrix = -matrix
    determinant = float(np.linalg.det(matrix[:, :3]))
    if determinant <= 0:
        raise InputError("its projection is singular or shows the mesh in a mirror; y must point down.")
    inner, rotation = rq(matrix[:, :3])
    signs = np.sign(np.diag(inner))  # a focal length is positive
    inner, rotation = inner * signs, rotation * signs[:, None]
    scale = inner[2, 2]
    inner = inner / scale
    if abs(inner[0, 1]) > _SKEWED * inner[0, 0]:
        raise InputError("its projection is skewed: pixels would not be rectangles.")
    shift = np.linalg.solve(inner, matrix[:, 3]) / scale
    depth = vertices @ rotation[2] + shift[2]
    if depth.min() <= 0:
        raise InputError("its camera stands within the mesh or before a part of it.")
    (fx, _, cx), (_, fy, cy) = inner[0], inner[1]
    window = (-cx / fx, (side - cx) / fx, (cy - side) / fy, cy / fy)
    upright = np.diag([1.0, -1.0, -1.0])  # from y down and z forward
    near, far = 0.99 * float(depth.min()), 1.01 * float(depth.max())
    return Camera(upright @ rotation, upright @ shift, True, window, near, far)


def _orthographic(matrix: Doubles, placed: PlacedMesh, side: int) -> Camera:
    if matrix[2, 3] == 0:
        raise InputError("its projection is singular.")
    across, down = matrix[:2, :3] / matrix[2, 3]
    offset = matrix[:2, 3] / matrix[2, 3]
    lengths = float(np.linalg.norm(across)), float(np.linalg.norm(down))
    longer = max(lengths)
    if abs(across @ down) > _SKEWED * longer**2 or abs(lengths[0] - lengths[1]) > _SKEWED * longer:
        raise InputError("its orthographic projection is skewed or stretched.")
    x = across / lengths[0]
    y = -down - (-down @ x) * x
    y /= np.linalg.norm(y)
    rotation = np.stack([x, y, np.cross(x, y)])
    radius = float(np.linalg.norm(placed.mesh.vertices, axis=1).max())
    left, top = -offset[0] / lengths[0], offset[1] / lengths[1]
    window = (left, left + side / lengths[0], top - side / lengths[1], top)
    return Camera(rotation, np.array([0.0, 0.0, -2 * radius]), False, window, 0.9 * radius, 3.1 * radius)
