"""Registration: compute the camera that aligns a mesh with a drawing from a projection matrix."""

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

_CREASE_ANGLE = 40.0
"""Minimum angle in degrees of a hard edge; most of the drawn objects have hard edges."""
_SKEWED = 0.03
"""Maximum skew of a camera's axes, and maximum relative difference in scale of an orthographic camera's axes;
beyond it, normals are not mapped to normals."""


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh ready to render, with the transform back to its file's coordinates.

    Args:
        mesh: the mesh, centred and scaled to unit radius.
        to_file: (4, 4), transform from the mesh's coordinates to the file's.
    """

    mesh: Mesh
    to_file: Doubles


def read_placed_mesh(path: Path) -> PlacedMesh:
    """Return the mesh in a file, with the transform back to the file's coordinates.

    Raises:
        InputError: if the file cannot be read or has no surface.
    """
    file = MeshFile(str(path), crease_angle=_CREASE_ANGLE)
    return PlacedMesh(*place(file.name, file, *read_triangles(path)))


def camera_of(projection: Doubles, placed: PlacedMesh, side: int) -> Camera:
    """Return the camera that corresponds to a projection of a mesh onto a square drawing.

    A projection K [R | t] is decomposed by RQ decomposition (Hartley and Zisserman, "Multiple View Geometry",
    2nd edition, section 6.2.4). A projection whose last row is 0 0 0 w is orthographic.

    Args:
        projection: (3, 4), projection from homogeneous coordinates of the mesh file to pixels of the drawing,
            x right and y down from the upper left corner; its scale and sign are arbitrary.
        placed: the mesh.
        side: side of the drawing in pixels.

    Raises:
        InputError: if the projection is singular, skewed or mirrored, or the camera is inside the mesh.
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
    if matrix[2, 3] < 0:  # the origin, the centre of the mesh, must be in front of the camera
        matrix = -matrix
    determinant = float(np.linalg.det(matrix[:, :3]))
    if determinant <= 0:
        raise InputError("its projection is singular or shows the mesh in a mirror; y must point down.")
    inner, rotation = rq(matrix[:, :3])
    signs = np.sign(np.diag(inner))  # focal lengths must be positive
    inner, rotation = inner * signs, rotation * signs[:, None]
    scale = inner[2, 2]
    inner = inner / scale
    if abs(inner[0, 1]) > _SKEWED * inner[0, 0]:
        raise InputError("its projection is skewed: pixels would not be rectangles.")
    shift = np.linalg.solve(inner, matrix[:, 3]) / scale
    depth = vertices @ rotation[2] + shift[2]
    if depth.min() <= 0:
        raise InputError("its camera is inside the mesh, or part of the mesh is behind it.")
    (fx, _, cx), (_, fy, cy) = inner[0], inner[1]
    window = (-cx / fx, (side - cx) / fx, (cy - side) / fy, cy / fy)
    upright = np.diag([1.0, -1.0, -1.0])  # from a camera with y down and z forward
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
