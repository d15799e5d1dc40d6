"""Surfaces of glTF: the triangles that a scene shows, each where its node puts it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.gltf.accessors import read_accessor
from normalgan.rendering.gltf.container import Container, bad_gltf, read_container, refusing_bad_gltf
from normalgan.rendering.gltf.nodes import read_nodes, shown_nodes, world_matrices

__all__ = ["MODES", "read_faces", "read_surfaces"]

MODES = (4, 5, 6)
"""Primitives that are lists, strips or fans of triangles; the others are points and lines."""


def read_surfaces(path: Path) -> list[tuple[Doubles, Indices]]:
    """Return the vertices (V, 3), in the world's axes, and faces (F, 3) of each surface that a file shows.

    Skinned surfaces are at rest, placed by their node. Morph targets are left at 0.

    Raises:
        InputError: if the file cannot be read, or is inconsistent.
    """
    with refusing_bad_gltf(path):
        container = read_container(path)
        nodes = read_nodes(container)
        if not len(nodes.order):  # a library of meshes
            every = range(len(container.tree.get("meshes", [])))
            return [each for index in every for each in _surfaces(container, index, np.eye(4))]
        world = world_matrices(nodes)
        return [
            each
            for index in shown_nodes(container, nodes)
            if "mesh" in (entry := container.item("nodes", index))
            for each in _surfaces(container, entry["mesh"], world[index])
        ]


def _surfaces(container: Container, mesh: Any, matrix: Doubles) -> Iterator[tuple[Doubles, Indices]]:
    for part in container.item("meshes", mesh)["primitives"]:
        mode = part.get("mode", 4)
        if mode not in MODES or "POSITION" not in part["attributes"]:
            continue
        vertices = read_accessor(container, part["attributes"]["POSITION"], "VEC3").astype(np.float64)
        faces = read_faces(container, part, mode, len(vertices))
        with np.errstate(invalid="ignore"):  # coordinates that are not numbers are refused later
            placed = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        # A mirroring transform turns what was outside inside.
        yield placed, faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces


def read_faces(container: Container, part: dict[str, Any], mode: int, count: int) -> Indices:
    """Return the (F, 3) triangles of a primitive (glTF 2.0, section 3.7.2.1).

    Args:
        container: the file.
        part: the primitive.
        mode: 4 for a list of triangles, 5 for a strip, 6 for a fan.
        count: number of its vertices.

    Raises:
        InputError: if a face refers to a vertex that is not there.
    """
    if "indices" in part:
        corners = read_accessor(container, part["indices"], "SCALAR")[:, 0].astype(np.int64)
    else:
        corners = np.arange(count)
    if not 0 <= corners.min() <= corners.max() < count:
        raise bad_gltf(container.path, f"a face refers to vertex {corners.max()} of {count}")
    if mode == 4:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    a, b = corners[1:-1], corners[2:]
    if mode == 6:
        return np.stack([np.broadcast_to(corners[0], a.shape), a, b], axis=-1)
    faces = np.stack([corners[:-2], a, b], axis=-1)
    faces[1::2] = faces[1::2, [1, 0, 2]]  # every other triangle of a strip runs the other way
    return faces
