"""Meshes and cameras for the tests of this folder."""

from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from skimage.measure import marching_cubes

from needs import SHARED_MESHES
from normalgan.arrays import Doubles
from normalgan.rendering.cameras import Camera, framed, look_at_origin
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.repair import shade

trimesh: Any = import_module("trimesh")  # its types cover half of it

MESHES = Path(__file__).parents[2] / ".." / "shared" / "meshes"
needs_meshes = pytest.mark.skipif(not MESHES.is_dir(), reason=SHARED_MESHES.reason("it is not there"))

BALL = trimesh.creation.icosphere(subdivisions=3)


def as_mesh(name: str, points: NDArray[np.floating], triangles: NDArray[np.integer]) -> Mesh:
    vertices, faces, normals = shade(points.astype(np.float64), triangles.astype(np.int64), None)
    return Mesh(name, vertices.astype(np.float32), faces.astype(np.int32), normals.astype(np.float32))


@cache
def ellipsoid(a: float, b: float, c: float, subdivisions: int = 5) -> Mesh:
    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    return as_mesh("ellipsoid", ball.vertices * [a, b, c], ball.faces)


@cache
def blob() -> Mesh:
    """A body on four legs with a neck and a head: concave, and hiding parts of itself."""
    axis = np.linspace(-1, 1, 64)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    field = -0.9 * np.ones_like(x)
    balls = [(0.3 * i - 0.45, 0.1, 0.0, 0.2) for i in range(4)] + [
        (0.5, 0.25, 0.0, 0.14),
        (0.62, 0.42, 0.0, 0.16),
    ]
    balls += [
        (sx * 0.4, -0.35 + 0.12 * i, sz * 0.15, 0.08) for sx in (-1, 1) for sz in (-1, 1) for i in range(4)
    ]
    for bx, by, bz, radius in balls:
        field += np.exp(-((x - bx) ** 2 + (y - by) ** 2 + (z - bz) ** 2) / radius**2)
    field += 0.02 * np.sin(23 * x) * np.sin(19 * y + 1) * np.sin(17 * z + 2)
    vertices, faces, _, _ = marching_cubes(field, 0.0, spacing=(2 / 63,) * 3)
    vertices = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    vertices /= np.linalg.norm(vertices, axis=1).max()
    solid = trimesh.Trimesh(vertices, faces, process=False)
    return as_mesh("blob", vertices, faces if solid.volume > 0 else faces[:, ::-1])


@cache
def bowl() -> Mesh:
    """A sphere without its cap about +Z: from there one sees its inside through the hole."""
    ball = trimesh.creation.icosphere(subdivisions=5)
    return as_mesh("bowl", ball.vertices, ball.faces[ball.triangles_center[:, 2] < 0.5])


def camera_at(
    mesh: Mesh,
    azimuth: float = 30,
    elevation: float = 20,
    roll: float = 10,
    field_of_view: float | None = None,
) -> Camera:
    return framed(mesh.vertices, look_at_origin(azimuth, elevation, roll), field_of_view, 0.06)


def angles(a: NDArray[np.floating], b: NDArray[np.floating]) -> Doubles:
    """Return the angles in degrees between vectors (..., 3)."""
    one, other = a.astype(np.float64), b.astype(np.float64)
    across = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.rad2deg(np.arctan2(across, (one * other).sum(axis=-1))))


def solid(mesh: Mesh) -> Any:
    """Return the mesh as trimesh knows it."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def write(path: Path, vertices: Any, faces: Any) -> MeshFile:
    """Write an OFF file by hand, exactly as given."""
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(str, vertex)) for vertex in vertices]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return MeshFile(str(path))
