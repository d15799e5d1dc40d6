"""MeshSurface: a mesh with its differential operators and curvature, computed once per mesh."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.mesh import Mesh

_Operator = Any  # a sparse matrix, because SciPy's types are not generic in the other factor


@dataclass(frozen=True)
class MeshSurface:
    """A triangle mesh with its edges, and linear operators on values at its vertices.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices.
        normals: (V, 3) unit vectors.
        edges: (E, 2) vertex indices, each edge once.
        sides: (F, 3) edge indices of each face.
        gradient: three (V, V) matrices from values at the vertices to the x, y and z components of their
            gradient, the area-weighted mean over the faces around each vertex.
        average: (V, V) matrix that replaces each value by the mean of itself and of its neighbours' mean.
        spacing: mean length of an edge.
    """

    vertices: Doubles
    faces: Indices
    normals: Doubles
    edges: Indices
    sides: Indices
    gradient: tuple[_Operator, _Operator, _Operator]
    average: _Operator
    spacing: float

    @classmethod
    def of(cls, mesh: Mesh) -> "MeshSurface":
        """Return the surface of a mesh."""
        vertices, faces = mesh.vertices.astype(np.float64), mesh.faces.astype(np.int64)
        pairs = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
        # One integer per pair sorts many times faster than rows.
        keys, sides = np.unique(pairs[:, 0] * len(vertices) + pairs[:, 1], return_inverse=True)
        edges = np.stack([keys // len(vertices), keys % len(vertices)], axis=1)
        lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
        return cls(
            vertices,
            faces,
            mesh.normals.astype(np.float64),
            edges,
            sides.reshape(-1, 3),
            _gradient(vertices, faces),
            _average(edges, len(vertices)),
            float(lengths.mean()),
        )

    def smooth(self, values: Doubles, sigma: float) -> Doubles:
        """Return values (V, …) at the vertices after smoothing by diffusion over ``sigma``, in mesh units."""
        smoothed = values.reshape(len(values), -1)
        # Each iteration moves a value to a neighbour with probability 1/2, a step of variance spacing² /
        # 2.
        for _ in range(round(4 * (sigma / self.spacing) ** 2)):
            smoothed = self.average @ smoothed
        return np.asarray(smoothed).reshape(values.shape)

    def slope(self, values: Doubles) -> Doubles:
        """Return the gradient (V, 3) of values (V,) along the surface, per mesh unit."""
        return np.stack([part @ values for part in self.gradient], axis=1)


def _gradient(vertices: Doubles, faces: Indices) -> tuple[_Operator, _Operator, _Operator]:
    opposite = [vertices[faces[:, (k + 2) % 3]] - vertices[faces[:, (k + 1) % 3]] for k in range(3)]
    across = np.cross(opposite[0], opposite[1])  # normal vectors of twice the area
    area = np.linalg.norm(across, axis=1)
    around = np.maximum(np.bincount(faces.ravel(), np.repeat(area, 3), len(vertices)), 1e-30)
    unit = across / np.maximum(area, 1e-30)[:, None]
    # The gradient of a corner's hat function is perpendicular to the opposite edge; here times twice the
    # area.
    climbs = [np.cross(unit, edge) for edge in opposite]
    rows = np.concatenate([faces[:, i] for i in range(3) for _ in range(3)])
    columns = np.concatenate([faces[:, j] for _ in range(3) for j in range(3)])
    shape = (len(vertices), len(vertices))

    def part(axis: int) -> _Operator:
        values = np.concatenate([climbs[j][:, axis] for _ in range(3) for j in range(3)]) / around[rows]
        return sparse.csr_array((values, (rows, columns)), shape=shape)

    return part(0), part(1), part(2)


def _average(edges: Indices, count: int) -> _Operator:
    rows, columns = np.concatenate([edges, edges[:, ::-1]]).T
    degree = np.bincount(rows, minlength=count)
    values = np.concatenate([0.5 / degree[rows], np.where(degree == 0, 1.0, 0.5)])
    own = np.arange(count)
    places = (np.concatenate([rows, own]), np.concatenate([columns, own]))
    return sparse.csr_array((values, places), shape=(count, count))


@dataclass(frozen=True)
class SurfaceShape:
    """Normals and curvature of a mesh at its vertices.

    Args:
        surface: the mesh.
        normals: (V, 3) smoothed unit normals.
        operators: (V, 3, 3) shape operators; see `shape_operators`.
    """

    surface: MeshSurface
    normals: Doubles
    operators: Doubles


# Views of a mesh are rendered in a row, so each process caches only one mesh, and memory stays constant.
# Its shapes are keyed by smoothing, which differs between the styles of a mixture.
_last: tuple[Mesh, MeshSurface, dict[float, SurfaceShape]] | None = None


def shape_of(mesh: Mesh, smoothing: float) -> SurfaceShape:
    """Return the shape of a mesh, with curvature smoothed over ``smoothing`` mesh units."""
    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] is not mesh:
        _last = (mesh, MeshSurface.of(mesh), {})
    _, surface, shapes = _last
    if smoothing not in shapes:
        normals = smooth_normals(surface, smoothing)
        shapes[smoothing] = SurfaceShape(surface, normals, shape_operators(surface, normals, smoothing))
    return shapes[smoothing]


def smooth_normals(surface: MeshSurface, smoothing: float) -> Doubles:
    """Return the unit normals (V, 3) of a mesh, smoothed over ``smoothing`` mesh units."""
    return _unit(surface.smooth(surface.normals, smoothing))


def shape_operators(surface: MeshSurface, normals: Doubles, smoothing: float) -> Doubles:
    """Return the symmetric shape operator S at each vertex, (V, 3, 3).

    A step s along the surface changes the normal by ``S s``. ``S n = 0``, and ``u · S u`` is the curvature
    along the unit tangent u, which is positive for a convex surface such as a ball. For each face, S is
    fitted to the differences of the normals along its three sides by least squares. At a vertex, it is the
    average over the surrounding faces, rotated into the tangent plane. The weight of a face is the part of
    its area that is closest to the vertex (Rusinkiewicz, "Estimating Curvatures and Their Derivatives on
    Triangle Meshes", 3DPVT 2004, sections 3.1 to 3.3).

    Args:
        surface: the mesh.
        normals: (V, 3) unit vectors.
        smoothing: standard deviation of the Gaussian applied to the curvature, in mesh units.
    """
    corners = surface.vertices[surface.faces]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # side k is opposite corner k
    first = _unit(sides[:, 0])
    facing = _unit(np.cross(sides[:, 0], sides[:, 1]))
    second = np.cross(facing, first)
    fitted = _fit(sides, normals[surface.faces], first, second)
    weights = _nearest_areas(sides)
    summed = np.zeros((len(normals), 9))
    total = np.zeros(len(normals))
    for k in range(3):
        own = surface.faces[:, k]
        turned = np.stack([_tilt(axis, facing, normals[own]) for axis in (first, second)], axis=2)
        here = (turned @ fitted @ turned.transpose(0, 2, 1)).reshape(-1, 9) * weights[:, k, None]
        total += np.bincount(own, weights[:, k], len(normals))
        for entry in range(9):
            summed[:, entry] += np.bincount(own, here[:, entry], len(normals))
    operators = surface.smooth(summed / np.maximum(total, 1e-30)[:, None], smoothing).reshape(-1, 3, 3)
    flat = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    return flat @ operators @ flat


def _fit(sides: Doubles, normals: Doubles, first: Doubles, second: Doubles) -> Doubles:
    """Return the symmetric matrices (F, 2, 2) that best map sides of faces to differences of normals."""
    turns = np.roll(normals, -2, axis=1) - np.roll(normals, -1, axis=1)
    u, v = (np.einsum("fkc,fc->fk", sides, axis) for axis in (first, second))
    du, dv = (np.einsum("fkc,fc->fk", turns, axis) for axis in (first, second))
    uu, uv, vv = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    zero = np.zeros_like(uu)
    left = np.stack([uu, uv, zero, uv, uu + vv, uv, zero, uv, vv], axis=1).reshape(-1, 3, 3)
    right = np.stack([(u * du).sum(1), (v * du + u * dv).sum(1), (v * dv).sum(1)], axis=1)
    # The fit is undetermined across a sliver, where damping sets it to 0.
    damping = 1e-9 * (uu + vv) + 1e-30
    left += damping[:, None, None] * np.eye(3)
    a, b, c = np.linalg.solve(left, right[..., None])[..., 0].T
    return np.stack([a, b, b, c], axis=1).reshape(-1, 2, 2)


def _nearest_areas(sides: Doubles) -> Doubles:
    """Return the Voronoi areas (F, 3) of each face's corners.

    Obtuse faces give half of their area to the obtuse corner and a quarter to each other corner, as in
    Meyer, Desbrun, Schröder and Barr, "Discrete Differential-Geometry Operators for Triangulated
    2-Manifolds", 2003.
    """
    square = (sides * sides).sum(2)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    # Cotangent at corner k, where sides k + 1 and k + 2 meet with opposite directions.
    dots = -np.stack([(sides[:, (k + 1) % 3] * sides[:, (k + 2) % 3]).sum(1) for k in range(3)], axis=1)
    cotangent = dots / np.maximum(2 * area, 1e-30)[:, None]
    shares = square * cotangent / 8
    voronoi = np.roll(shares, -1, axis=1) + np.roll(shares, -2, axis=1)
    obtuse = dots < 0
    safe = np.where(obtuse, 0.5, 0.25) * area[:, None]
    nearest: Doubles = np.where(obtuse.any(axis=1, keepdims=True), safe, voronoi)
    return nearest


def _tilt(vectors: Doubles, old: Doubles, new: Doubles) -> Doubles:
    """Return tangent vectors (F, 3) after the minimal rotation from the old to the new normal."""
    cosine = (old * new).sum(1)
    # On a fold, normals are opposite, and any rotation axis will do.
    factor = (vectors * new).sum(1) / np.maximum(1 + cosine, 1e-6)
    tilted: Doubles = vectors - (old + new) * factor[:, None]
    return tilted


def _unit(vectors: Doubles) -> Doubles:
    unit: Doubles = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
    return unit
