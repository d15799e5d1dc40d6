"""Solids with exact maps, and cameras that look at them."""

from functools import cache

import numpy as np
from trimesh.creation import icosphere

from normalgan.rendering.cameras import Camera, framed, look_at_origin
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh

RADII = (1.0, 0.6, 0.4)
"""Semi-axes of the ellipsoid for checking renderers, different along x, y and z."""


@cache
def ellipsoid() -> Mesh:
    """Return an ellipsoid of 20,480 triangles, with exact vertex normals."""
    ball = icosphere(subdivisions=5)
    normals = np.asarray(ball.vertices) / RADII
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = (ball.vertices * np.array(RADII)).astype(np.float32)
    return Mesh("ellipsoid", vertices, ball.faces.astype(np.int32), normals.astype(np.float32))


@cache
def bowl() -> Mesh:
    """Return a sphere without the cap around +Z, so that its inside is visible from there."""
    ball = icosphere(subdivisions=4)
    vertices = np.asarray(ball.vertices, np.float32)
    faces = ball.faces[ball.triangles_center[:, 2] < 0.5].astype(np.int32)
    return Mesh("bowl", vertices, faces, vertices / np.linalg.norm(vertices, axis=1, keepdims=True))


def camera(mesh: Mesh, field_of_view: float | None = None, front: bool = False) -> Camera:
    """Return a camera that looks at a mesh from the front, or tilted from slightly above and to the side."""
    rotation = look_at_origin(0, 0, 0) if front else look_at_origin(30, 20, 10)
    return framed(mesh.vertices, rotation, field_of_view, 0.06)


def away(mesh: Mesh) -> Camera:
    """Return a camera that looks past the mesh and sees nothing."""
    seen = camera(mesh)
    side = seen.window[1] - seen.window[0]
    aside = (seen.window[0] + 3 * side, seen.window[1] + 3 * side, seen.window[2], seen.window[3])
    return Camera(seen.rotation, seen.translation, seen.perspective, aside, seen.near, seen.far)


def exact_ellipsoid(radii: tuple[float, float, float], seen_by: Camera, size: int) -> Maps:
    """Return the exact maps of an ellipsoid at the origin by intersecting each pixel's ray."""
    origins, directions = seen_by.rays(size)
    o, d = origins / radii, directions / radii
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - 1
    mask = b * b - a * c > 0
    depth = np.where(mask, (-b - np.sqrt(np.maximum(b * b - a * c, 0))) / a, np.inf)
    points = origins + np.where(mask, depth, 0)[..., None] * directions
    normal = (points / np.square(radii)) @ seen_by.rotation.T * mask[..., None]
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    return Maps(normal.astype(np.float32), depth.astype(np.float32), mask)
