"""Surface: a mesh with its differential operators, made once per mesh."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.mesh import Mesh

__all__ = ["Operator", "Surface"]
Operator = Any  # a sparse matrix; SciPy's types are not generic over the other factor


@dataclass(frozen=True)
class Surface:
    """A triangle mesh, its edges, and linear operators on values at its vertices.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices.
        normals: (V, 3) unit vectors.
        edges: (E, 2) vertex indices, each edge once.
        sides: (F, 3) the edges of each face.
        gradient: three (V, V) matrices that turn values at the vertices into the x, y and z of their slope:
            the area-weighted mean over the faces around each vertex.
        average: (V, V) matrix that replaces each value by half of itself and half of its neighbours' mean.
        spacing: mean length of an edge.
    """

    vertices: Doubles
    faces: Indices
    normals: Doubles
    edges: Indices
    sides: Indices
    gradient: tuple[Operator, Operator, Operator]
    average: Operator
    spacing: float

    @classmethod
    def of(cls, mesh: Mesh) -> "Surface":
        """Return the surface of a mesh."""
        vertices, faces = mesh.vertices.astype(np.float64), mesh.faces.astype(np.int64)
        pairs = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
        # One number for each pair sorts many times faster than rows.
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
        """Return values (V, …) at the vertices smoothed by diffusion over ``sigma``, in units of the mesh."""
        smoothed = values.reshape(len(values), -1)
        # A round moves a value to a neighbour with probability 1/2, a step of variance spacing² / 2.
        for _ in range(round(4 * (sigma / self.spacing) ** 2)):
            smoothed = self.average @ smoothed
        return np.asarray(smoothed).reshape(values.shape)

    def slope(self, values: Doubles) -> Doubles:
        """Return the gradient (V, 3) of values (V,) along the surface, per unit of the mesh."""
        return np.stack([part @ values for part in self.gradient], axis=1)


def _gradient(vertices: Doubles, faces: Indices) -> tuple[Operator, Operator, Operator]:
    opposite = [vertices[faces[:, (k + 2) % 3]] - vertices[faces[:, (k + 1) % 3]] for k in range(3)]
    across = np.cross(opposite[0], opposite[1])  # twice the area, along the normal
    area = np.linalg.norm(across, axis=1)
    around = np.maximum(np.bincount(faces.ravel(), np.repeat(area, 3), len(vertices)), 1e-30)
    unit = across / np.maximum(area, 1e-30)[:, None]
    # The hat function of a corner climbs at right angles to the opposite edge; here times twice the area.
    climbs = [np.cross(unit, edge) for edge in opposite]
    rows = np.concatenate([faces[:, i] for i in range(3) for _ in range(3)])
    columns = np.concatenate([faces[:, j] for _ in range(3) for j in range(3)])
    shape = (len(vertices), len(vertices))

    def part(axis: int) -> Operator:
        values = np.concatenate([climbs[j][:, axis] for _ in range(3) for j in range(3)]) / around[rows]
        return sparse.csr_array((values, (rows, columns)), shape=shape)

    return part(0), part(1), part(2)


def _average(edges: Indices, count: int) -> Operator:
    rows, columns = np.concatenate([edges, edges[:, ::-1]]).T
    degree = np.bincount(rows, minlength=count)
    values = np.concatenate([0.5 / degree[rows], np.where(degree == 0, 1.0, 0.5)])
    own = np.arange(count)
    places = (np.concatenate([rows, own]), np.concatenate([columns, own]))
    return sparse.csr_array((values, places), shape=(count, count))
