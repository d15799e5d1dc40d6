"""The scene of a glTF: nodes that place meshes, and the visible triangles."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.gltf.accessors import read_accessor
from normalgan.rendering.gltf.container import Container, bad_gltf, read_container, refusing_bad_gltf


@dataclass(frozen=True)
class Nodes:
    """The nodes of a scene.

    Args:
        parents: (N,) index of each node's parent, -1 for none.
        order: (N,) all indices, parents before their children.
        translations: (N, 3) in the parent's axes, in the rest pose.
        rotations: (N, 4) unit quaternions x, y, z, w, in the rest pose.
        scales: (N, 3), in the rest pose.
        matrices: (4, 4) matrices, for column vectors, of nodes that have a matrix instead of these three,
            by node.
    """

    parents: Indices
    order: Indices
    translations: Doubles
    rotations: Doubles
    scales: Doubles
    matrices: dict[int, Doubles]


def read_nodes(container: Container) -> Nodes:
    """Return the nodes of a file.

    Raises:
        InputError: if the nodes are not a tree, or have an invalid number.
    """
    entries = container.tree.get("nodes", [])
    parents = np.full(len(entries), -1)
    for index, entry in enumerate(entries):
        for child in entry.get("children", []):
            container.item("nodes", child)
            if parents[child] >= 0:
                raise bad_gltf(container.path, f"node {child} has two parents")
            parents[child] = index
    order = [int(index) for index in np.flatnonzero(parents < 0)]
    for index in order:  # grows during the loop
        order += entries[index].get("children", [])
    if len(order) < len(entries):
        raise bad_gltf(container.path, "its nodes are their own ancestors")
    rotations = _rows(container, "rotation", (0.0, 0.0, 0.0, 1.0))
    lengths = np.linalg.norm(rotations, axis=1, keepdims=True)
    if (lengths < 0.5).any():
        raise bad_gltf(container.path, "a node's rotation is not a unit quaternion")
    matrices = {
        index: np.array(entry["matrix"], dtype=np.float64).reshape(4, 4).T  # stored in column-major order
        for index, entry in enumerate(entries)
        if "matrix" in entry
    }
    if not all(np.isfinite(matrix).all() for matrix in matrices.values()):
        raise bad_gltf(container.path, "a node's matrix has a number that is not finite")
    translations, scales = _rows(container, "translation", (0.0,) * 3), _rows(container, "scale", (1.0,) * 3)
    return Nodes(
        parents, np.array(order, dtype=np.int64), translations, rotations / lengths, scales, matrices
    )


def _rows(container: Container, name: str, default: tuple[float, ...]) -> Doubles:
    """Return one property of all nodes, (N, D)."""
    rows = [entry.get(name, default) for entry in container.tree.get("nodes", [])]
    values = np.array(rows, dtype=np.float64).reshape(-1, len(default))
    if len(values) != len(rows) or not np.isfinite(values).all():
        raise bad_gltf(container.path, f"a node's {name} has a number that is not finite")
    return values


def shown_nodes(container: Container, nodes: Nodes) -> list[int]:
    """Return the nodes of the scene, or all nodes if the file has no scene."""
    if not container.tree.get("scenes"):
        return [int(index) for index in nodes.order]
    roots = set(container.item("scenes", container.tree.get("scene", 0)).get("nodes", []))
    for index in nodes.order:
        if int(nodes.parents[index]) in roots:
            roots.add(int(index))
    return sorted(roots)


def world_matrices(nodes: Nodes) -> Doubles:
    """Return the (N, 4, 4) matrices from each node's axes to the world's, for column vectors."""
    matrices = np.zeros((len(nodes.parents), 4, 4))
    if len(matrices):
        turns = Rotation.from_quat(nodes.rotations).as_matrix()
        matrices[:, :3, :3] = turns * nodes.scales[:, None, :]
    matrices[:, :3, 3] = nodes.translations
    matrices[:, 3, 3] = 1.0
    for index, matrix in nodes.matrices.items():
        matrices[index] = matrix
    for index in nodes.order:  # parents come first
        parent = nodes.parents[index]
        if parent >= 0:
            matrices[index] = matrices[parent] @ matrices[index]
    return matrices


def read_surfaces(path: Path) -> list[tuple[Doubles, Indices]]:
    """Return the vertices (V, 3), in world axes, and faces (F, 3) of each visible surface of a file.

    Skinned surfaces are in the rest pose, placed by their node. Morph targets are ignored.

    Raises:
        InputError: if the file cannot be read or is inconsistent.
    """
    with refusing_bad_gltf(path):
        container = read_container(path)
        nodes = read_nodes(container)
        if not len(nodes.order):  # a library of meshes without nodes
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
    for _, vertices, faces in read_primitives(container, mesh):
        with np.errstate(invalid="ignore"):  # invalid coordinates are refused later
            placed = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        # A mirroring transform reverses the winding.
        yield placed, faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces


_LIST, _STRIP, _FAN = 4, 5, 6
"""Primitive modes for triangles (glTF 2.0, section 3.7.2.1); the others are points and lines."""


def read_primitives(container: Container, mesh: Any) -> Iterator[tuple[dict[str, Any], Doubles, Indices]]:
    """Yield the attributes, vertices (V, 3) and triangles (F, 3) of a mesh's triangle primitives.

    Raises:
        InputError: if a face refers to a missing vertex, or there is no such mesh.
    """
    for part in container.item("meshes", mesh)["primitives"]:
        mode = part.get("mode", _LIST)
        if mode in (_LIST, _STRIP, _FAN) and "POSITION" in part["attributes"]:
            vertices = read_accessor(container, part["attributes"]["POSITION"], "VEC3").astype(np.float64)
            yield part["attributes"], vertices, _faces(container, part, mode, len(vertices))


def _faces(container: Container, part: dict[str, Any], mode: int, count: int) -> Indices:
    if "indices" in part:
        corners = read_accessor(container, part["indices"], "SCALAR")[:, 0].astype(np.int64)
    else:
        corners = np.arange(count)
    if not 0 <= corners.min() <= corners.max() < count:
        raise bad_gltf(container.path, f"a face refers to vertex {corners.max()} of {count}")
    if mode == _LIST:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    a, b = corners[1:-1], corners[2:]
    if mode == _FAN:
        return np.stack([np.broadcast_to(corners[0], a.shape), a, b], axis=-1)
    faces = np.stack([corners[:-2], a, b], axis=-1)
    faces[1::2] = faces[1::2, [1, 0, 2]]  # every other triangle of a strip has reversed winding
    return faces
