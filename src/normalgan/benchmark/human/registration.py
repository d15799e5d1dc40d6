"""Registration: the camera under which a mesh lies beneath a drawing, from a projection or from points."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.rendering.loading import read_triangles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile, place
from normalgan.rendering.views import Camera

__all__ = ["CREASE_ANGLE", "PlacedMesh", "camera_of", "fit_projection", "read_placed_mesh"]


CREASE_ANGLE = 40.0
"""Edges sharper than this, in degrees, stay hard: most objects that people were asked to draw have such."""
_SKEWED = 0.03
"""A camera whose axes are farther from right angles, or an orthographic one whose axes differ more in scale,
does not turn normals into normals."""
_FEWEST = 6
_FLAT = 0.01


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
    """Return the mesh in a file, and how to get back to the file's coordinates.

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
        side: of the drawing in pixels.

    Raises:
        InputError: if there is no such camera: it is singular, skewed, a mirror, or stands in the mesh.
    """
    matrix = projection @ placed.to_file
    if not np.isfinite(matrix).all() or np.linalg.norm(matrix[:, :3]) == 0:
        raise InputError("its projection is no matrix of finite numbers that looks at anything.")
    perspective = np.linalg.norm(matrix[2, :3]) > 1e-9 * np.linalg.norm(matrix[:2, :3])
    return _perspective(matrix, placed, side) if perspective else _orthographic(matrix, placed, side)


def _perspective(matrix: Doubles, placed: PlacedMesh, side: int) -> Camera:
    vertices = placed.mesh.vertices.astype(np.float64)
    if matrix[2, 3] < 0:  # the mesh's centre is the origin, and lies before the eye
        matrix = -matrix
    determinant = float(np.linalg.det(matrix[:, :3]))
    if determinant <= 0:
        raise InputError("its projection is singular or shows the mesh in a mirror; y is to go downwards.")
    inner, rotation = _rq(matrix[:, :3])
    scale = inner[2, 2]
    inner = inner / scale
    if abs(inner[0, 1]) > _SKEWED * inner[0, 0]:
        raise InputError("its projection is skewed: pixels would be no rectangles.")
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


def _rq(matrix: Doubles) -> tuple[Doubles, Doubles]:
    """Return an upper triangular matrix with a positive diagonal, and a rotation, whose product it is."""
    flipped, triangle = np.linalg.qr(matrix[::-1].T)
    upper, rotation = triangle.T[::-1, ::-1], flipped.T[::-1]
    signs = np.sign(np.diag(upper))
    return upper * signs, rotation * signs[:, None]


def fit_projection(points: Doubles, pixels: Doubles) -> tuple[Doubles, float]:
    """Return the camera that sees points at pixels, and by how many pixels it misses them in the mean.

    Square pixels, no skew, any centre: found by the direct linear transform (Hartley and Zisserman,
    algorithm 7.1) and refined by least squares over its nine parameters.

    Args:
        points: (N, 3) on the object, N at least 6 and not in one plane.
        pixels: (N, 2) on the drawing, y downwards.

    Returns:
        The (3, 4) projection, and the mean distance in pixels.

    Raises:
        InputError: if they determine no camera.
    """
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation

    if len(points) != len(pixels):
        raise InputError(
            f"{len(points)} points of it are given, and {len(pixels)} places where they are drawn."
        )
    if len(points) < _FEWEST or points.shape != (len(pixels), 3) or pixels.shape != (len(points), 2):
        raise InputError(f"a camera is fitted to {_FEWEST} pairs of points or more, not to {len(points)}.")
    centre, middle = points.mean(axis=0), pixels.mean(axis=0)
    spread, reach = np.abs(points - centre).max(), np.abs(pixels - middle).max()
    thickness = np.linalg.svd(points - centre, compute_uv=False)
    if not thickness[2] > _FLAT * thickness[0] or not reach > 0:
        raise InputError("its points lie in one plane, which leaves the camera open.")
    near, flat = (points - centre) / spread, (pixels - middle) / reach
    start = _direct_linear(near, flat)
    inner, rotation = _rq(start[:, :3] * np.sign(np.linalg.det(start[:, :3])))
    start = start * np.sign(np.linalg.det(start[:, :3]))
    shift = np.linalg.solve(inner, start[:, 3])
    inner = inner / inner[2, 2]
    focal = (inner[0, 0] + inner[1, 1]) / 2
    first = np.array([np.log(focal), *inner[:2, 2], *Rotation.from_matrix(rotation).as_rotvec(), *shift])

    def build(values: Doubles) -> Doubles:
        f = np.exp(values[0])
        calibration = np.array([[f, 0, values[1]], [0, f, values[2]], [0, 0, 1]])
        turned = Rotation.from_rotvec(values[3:6]).as_matrix()
        return np.asarray(calibration @ np.c_[turned, values[6:]])

    def misses(values: Doubles) -> Doubles:
        return np.asarray((_project(build(values), near) - flat).ravel())

    found = build(least_squares(misses, first, x_scale="jac").x)
    to_points, to_pixels = np.eye(4), np.array([[reach, 0, middle[0]], [0, reach, middle[1]], [0, 0, 1]])
    to_points[:3, :3] /= spread
    to_points[:3, 3] = -centre / spread
    projection = to_pixels @ found @ to_points
    missed = np.linalg.norm(_project(projection, points) - pixels, axis=1)
    return projection, float(missed.mean())


def _direct_linear(points: Doubles, pixels: Doubles) -> Doubles:
    whole, none = np.c_[points, np.ones(len(points))], np.zeros((len(points), 4))
    rows = np.r_[
        np.c_[whole, none, -pixels[:, :1] * whole],
        np.c_[none, whole, -pixels[:, 1:] * whole],
    ]
    found: Doubles = np.linalg.svd(rows)[2][-1].reshape(3, 4)
    return found


def _project(projection: Doubles, points: Doubles) -> Doubles:
    seen = np.c_[points, np.ones(len(points))] @ projection.T
    return np.asarray(seen[:, :2] / seen[:, 2:])
