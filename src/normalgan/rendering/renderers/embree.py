"""EmbreeRenderer: casts one ray a pixel on the CPU; needs neither OpenGL nor any system package."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles
from normalgan.rendering.cameras import Camera, project
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import RENDERERS, Renderer

__all__ = ["EmbreeRenderer"]


_CANCELLED = 1e-4
"""Interpolated normals shorter than this have cancelled each other out."""

# The mesh rendered last and its scene, as views of a mesh are rendered in a row. It belongs to the process.
_last: tuple[Mesh, Any] | None = None


@RENDERERS.register
@dataclass(frozen=True)
class EmbreeRenderer(Renderer):
    """Ray casting by Intel Embree on the CPU: works everywhere, best at small sizes.

    Embree (Wald et al., ACM Transactions on Graphics 33(4), 2014) says in float32 which triangle a pixel
    sees; the point on the triangle and its normal are computed here in float64.
    """

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the maps of ``mesh`` seen by ``camera``; see `Renderer.render`."""
        rows, columns = _pixels_in_reach(mesh, camera, size)
        origins, directions = (part[rows, columns].reshape(-1, 3) for part in camera.rays(size))
        # From the near plane, so that float32 spends no digits on the distance to it.
        started = origins + camera.near * directions
        hit = _scene(mesh).run(started.astype(np.float32), directions.astype(np.float32))
        pixels = np.flatnonzero(hit >= 0)
        normals, depth = _shade(mesh, hit[pixels], origins[pixels], directions[pixels])

        inside = np.zeros((size, size), dtype=bool)
        inside[rows, columns] = (hit >= 0).reshape(inside[rows, columns].shape)
        maps = Maps(
            normal=np.zeros((size, size, 3), dtype=np.float32),
            depth=np.full((size, size), np.inf, dtype=np.float32),
            mask=inside,
        )
        maps.normal[inside] = normals @ camera.rotation.T
        maps.depth[inside] = depth
        return maps


def _scene(mesh: Mesh) -> Any:
    """Return Embree's search tree of the mesh, cached until the mesh changes."""
    from embreex.mesh_construction import TriangleMesh  # 0.1 s, only when it renders
    from embreex.rtcore_scene import EmbreeScene

    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] is not mesh:
        scene = EmbreeScene()
        TriangleMesh(scene, mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32))
        _last = (mesh, scene)
    return _last[1]


def _pixels_in_reach(mesh: Mesh, camera: Camera, size: int) -> tuple[slice, slice]:
    """Return the rows and columns of the smallest rectangle of pixels that holds the projected mesh."""
    place, depth = project(camera, mesh.vertices.astype(np.float64), size)
    if camera.perspective and depth.min() <= 0:  # behind the eye, where a projection is meaningless
        return slice(0, size), slice(0, size)
    x, y = place.T
    bounds = [int(np.clip(edge, 0, size)) for edge in (y.min(), y.max() + 1, x.min(), x.max() + 1)]
    return slice(bounds[0], bounds[1]), slice(bounds[2], bounds[3])


def _shade(
    mesh: Mesh, faces: NDArray[np.integer], origins: Doubles, directions: Doubles
) -> tuple[Doubles, Doubles]:
    """Return the normals (P, 3), facing the viewer, and depths (P,) where rays meet their triangles.

    Barycentric coordinates as in Möller and Trumbore, Journal of Graphics Tools 2(1), 1997.
    """
    corners = mesh.faces[faces]
    a, b, c = (mesh.vertices[corners[:, i]].astype(np.float64) for i in range(3))
    edge1, edge2, offset = b - a, c - a, origins - a
    across = np.cross(directions, edge2)
    turned = np.cross(offset, edge1)
    # 0 only for triangles too thin for float32, where any point will do.
    scale = _dot(edge1, across)
    scale = np.where(scale == 0, np.finfo(np.float64).tiny, scale)
    u = np.clip(_dot(offset, across) / scale, 0, 1)
    v = np.clip(_dot(directions, turned) / scale, 0, 1 - u)
    depth = _dot(a + u[:, None] * edge1 + v[:, None] * edge2 - origins, directions)
    depth /= _dot(directions, directions)

    weights = np.stack([1 - u - v, u, v], axis=-1)
    normals = np.einsum("pk,pkc->pc", weights, mesh.normals[corners].astype(np.float64))
    flat = np.cross(edge1, edge2)
    # The corners' normals may cancel on a fold; then the normal of the triangle is used.
    cancelled = _dot(normals, normals) < _CANCELLED**2
    normals[cancelled] = flat[cancelled]
    # Seen from behind is what the triangle says, not the normal: on a coarse mesh a normal near the
    # silhouette may lean away from the viewer on a triangle that faces him.
    normals[_dot(flat, directions) > 0] *= -1
    return normals / np.linalg.norm(normals, axis=1, keepdims=True), depth


def _dot(a: Doubles, b: Doubles) -> Doubles:
    return np.asarray(np.einsum("pc,pc->p", a, b))
