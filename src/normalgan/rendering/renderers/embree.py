"""EmbreeRenderer: casts one ray per pixel on the CPU, without OpenGL or system packages."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles
from normalgan.rendering.cameras import Camera, project
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import RENDERERS, Renderer

_CANCELLED = 1e-4
"""Length below which interpolated normals have cancelled each other out."""

# Each process caches the last mesh with its scene, because views of a mesh are rendered in a row.
_last: tuple[Mesh, Any] | None = None


@RENDERERS.register
@dataclass(frozen=True)
class EmbreeRenderer(Renderer):
    """Ray casting by Intel Embree on the CPU, which works everywhere and is best at small sizes.

    Embree (Wald et al., ACM Transactions on Graphics 33(4), 2014) determines the visible triangle of a
    pixel in float32. The point on the triangle and its normal are computed here in float64.
    """

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the maps of a mesh viewed by a camera; see `Renderer.render`."""
        rows, columns = _pixels_in_reach(mesh, camera, size)
        origins, directions = (part.reshape(-1, 3) for part in camera.rays(size, rows, columns))
        # Rays start at the near plane, so that float32 wastes no digits on the distance to it.
        started = origins + camera.near * directions
        hit = _scene(mesh).run(started.astype(np.float32), directions.astype(np.float32))
        pixels = np.flatnonzero(hit >= 0)
        normals, depth = _shade(mesh, hit[pixels], origins.T[:, pixels], directions.T[:, pixels])

        inside = np.zeros((size, size), dtype=bool)
        inside[rows, columns] = (hit >= 0).reshape(inside[rows, columns].shape)
        maps = Maps(
            normal=np.zeros((size, size, 3), dtype=np.float32),
            depth=np.full((size, size), np.inf, dtype=np.float32),
            mask=inside,
        )
        maps.normal[inside] = normals.T @ camera.rotation.T
        maps.depth[inside] = depth
        return maps


def _scene(mesh: Mesh) -> Any:
    """Return Embree's search tree of the mesh, cached until the mesh changes."""
    from embreex.mesh_construction import TriangleMesh  # takes 0.1 s to import, only needed to render
    from embreex.rtcore_scene import EmbreeScene

    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] is not mesh:
        scene = EmbreeScene()
        TriangleMesh(scene, mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32))
        _last = (mesh, scene)
    return _last[1]


def _pixels_in_reach(mesh: Mesh, camera: Camera, size: int) -> tuple[slice, slice]:
    """Return the rows and columns of the smallest rectangle of pixels that contains the projected mesh."""
    place, depth = project(camera, mesh.vertices.astype(np.float64), size)
    if camera.perspective and depth.min() <= 0:  # behind the camera, where a projection is meaningless
        return slice(0, size), slice(0, size)
    x, y = place.T
    bounds = [int(np.clip(edge, 0, size)) for edge in (y.min(), y.max() + 1, x.min(), x.max() + 1)]
    return slice(bounds[0], bounds[1]), slice(bounds[2], bounds[3])


def _shade(
    mesh: Mesh, faces: NDArray[np.integer], origins: Doubles, directions: Doubles
) -> tuple[Doubles, Doubles]:
    """Return the normals (3, P), facing the viewer, and depths (P,) where rays (3, P) hit their triangles.

    Barycentric coordinates are computed as in Möller and Trumbore, Journal of Graphics Tools 2(1), 1997.
    Coordinates are the first axis, because NumPy is much faster on long rows than on many short ones.
    """
    corners = mesh.faces.T[:, faces]
    vertices = np.ascontiguousarray(mesh.vertices.T, dtype=np.float64)
    a, b, c = (vertices[:, corner] for corner in corners)
    edge1, edge2, offset = b - a, c - a, origins - a
    across = _cross(directions, edge2)
    turned = _cross(offset, edge1)
    # The determinant is 0 only for triangles too thin for float32, where any point will do.
    scale = _dot(edge1, across)
    scale[scale == 0] = np.finfo(np.float64).tiny
    u = np.clip(_dot(offset, across) / scale, 0, 1)
    v = np.clip(_dot(directions, turned) / scale, 0, 1 - u)
    depth = _dot(a + u * edge1 + v * edge2 - origins, directions) / _dot(directions, directions)

    at_vertices = np.ascontiguousarray(mesh.normals.T, dtype=np.float64)
    n_a, n_b, n_c = (at_vertices[:, corner] for corner in corners)
    normals = (1 - u - v) * n_a + u * n_b + v * n_c
    flat = _cross(edge1, edge2)
    # The corners' normals may cancel on a fold, where the normal of the triangle is used instead.
    cancelled = _dot(normals, normals) < _CANCELLED**2
    normals[:, cancelled] = flat[:, cancelled]
    # The triangle decides whether it is viewed from behind, because on a coarse mesh, a normal near the
    # silhouette may face away from the viewer on a triangle that faces the viewer.
    normals *= np.where(_dot(flat, directions) > 0, -1, 1) / np.sqrt(_dot(normals, normals))
    return normals, depth


def _dot(a: Doubles, b: Doubles) -> Doubles:
    products = a * b  # adding rows is faster than a sum along the axis
    return np.asarray(products[0] + products[1] + products[2])


def _cross(a: Doubles, b: Doubles) -> Doubles:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
