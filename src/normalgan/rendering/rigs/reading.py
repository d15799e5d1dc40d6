"""Read a rig from a glTF file: nodes, skins and the surfaces bound to them, all checked."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from normalgan.arrays import Doubles
from normalgan.errors import InputError, brief
from normalgan.rendering.mesh_limits import check_limits
from normalgan.rendering.rigs.accessors import read_accessor
from normalgan.rendering.rigs.animations import read_clips
from normalgan.rendering.rigs.container import Container, bad_rig, read_container
from normalgan.rendering.rigs.rig import Indices, Nodes, Piece, Rig, Skin

__all__ = ["MOST_SETS", "SUM_TOLERANCE", "read_rig"]

MOST_SETS = 4
"""Joints and weights of a vertex come in sets of four."""
SUM_TOLERANCE = 0.05
"""How far the weights of a vertex may be from 1: bytes are 0.008 off, weak joints left out a little more."""


def read_rig(path: Path) -> Rig:
    """Return the rig in a glTF file.

    Skins are those of the specification (glTF 2.0, section 3.7.3). Morph targets are left at 0.

    Raises:
        InputError: if the file cannot be read, holds no surface, or a rig that does not hold together.
    """
    try:
        container = read_container(path)
        check_limits(path)
        nodes = _nodes(container)
        pieces = tuple(
            piece for index in _shown(container, nodes) for piece in _pieces(container, nodes, index)
        )
        clips = read_clips(container, nodes)
        names = tuple(str(entry.get("name", "")) for entry in container.tree.get("nodes", []))
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise bad_rig(path, f"it is not as glTF 2.0 says: {type(error).__name__}: {brief(error)}") from error
    if not any(len(piece.faces) for piece in pieces):
        raise bad_rig(path, "its scene shows no triangles")
    return Rig(nodes, pieces, clips, names)


def _nodes(container: Container) -> Nodes:
    entries = container.tree.get("nodes", [])
    parents = np.full(len(entries), -1)
    for index, entry in enumerate(entries):
        for child in entry.get("children", []):
            container.item("nodes", child)
            if parents[child] >= 0:
                raise bad_rig(container.path, f"node {child} has two parents")
            parents[child] = index
    order = [int(index) for index in np.flatnonzero(parents < 0)]
    for index in order:  # grows while it is walked
        order += entries[index].get("children", [])
    if len(order) < len(entries):
        raise bad_rig(container.path, "its nodes are their own ancestors")
    rotations = _rows(container, "rotation", (0.0, 0.0, 0.0, 1.0))
    lengths = np.linalg.norm(rotations, axis=1, keepdims=True)
    if (lengths < 0.5).any():
        raise bad_rig(container.path, "a node's rotation is no unit quaternion")
    matrices = {
        index: np.array(entry["matrix"], dtype=np.float64).reshape(4, 4).T  # stored column by column
        for index, entry in enumerate(entries)
        if "matrix" in entry
    }
    if not all(np.isfinite(matrix).all() for matrix in matrices.values()):
        raise bad_rig(container.path, "a node's matrix has a number that is not finite")
    translations, scales = _rows(container, "translation", (0.0,) * 3), _rows(container, "scale", (1.0,) * 3)
    return Nodes(
        parents, np.array(order, dtype=np.int64), translations, rotations / lengths, scales, matrices
    )


def _rows(container: Container, name: str, default: tuple[float, ...]) -> Doubles:
    """Return one property of all nodes, (N, D)."""
    rows = [entry.get(name, default) for entry in container.tree.get("nodes", [])]
    values = np.array(rows, dtype=np.float64).reshape(-1, len(default))
    if len(values) != len(rows) or not np.isfinite(values).all():
        raise bad_rig(container.path, f"a node's {name} has a number that is not finite")
    return values


def _shown(container: Container, nodes: Nodes) -> list[int]:
    """Return the nodes of the scene, or all if the file has none."""
    if not container.tree.get("scenes"):
        return [int(index) for index in nodes.order]
    roots = set(container.item("scenes", container.tree.get("scene", 0)).get("nodes", []))
    for index in nodes.order:
        if int(nodes.parents[index]) in roots:
            roots.add(int(index))
    return sorted(roots)


def _pieces(container: Container, nodes: Nodes, index: int) -> list[Piece]:
    entry = container.item("nodes", index)
    if "mesh" not in entry:
        return []
    skin = _skin(container, nodes, entry["skin"]) if "skin" in entry else None
    pieces = []
    for part in container.item("meshes", entry["mesh"])["primitives"]:
        mode = part.get("mode", 4)
        if mode not in (4, 5, 6):
            continue  # points and lines
        vertices = read_accessor(container, part["attributes"]["POSITION"], "VEC3").astype(np.float64)
        if not np.isfinite(vertices).all():
            raise bad_rig(container.path, "a vertex has a coordinate that is not finite")
        faces = _faces(container, part, mode, len(vertices))
        pieces.append(_bound(container, part["attributes"], skin, vertices, faces, index))
    return pieces


def _faces(container: Container, part: dict[str, Any], mode: int, count: int) -> Indices:
    """Return the (F, 3) triangles of a list, a strip or a fan of them."""
    if "indices" in part:
        corners = read_accessor(container, part["indices"], "SCALAR")[:, 0].astype(np.int64)
    else:
        corners = np.arange(count)
    if corners.max() >= count:
        raise bad_rig(container.path, f"a face refers to vertex {corners.max()} of {count}")
    if mode == 4:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    a, b = corners[1:-1], corners[2:]
    if mode == 6:
        return np.stack([np.broadcast_to(corners[0], a.shape), a, b], axis=-1)
    faces = np.stack([corners[:-2], a, b], axis=-1)
    faces[1::2] = faces[1::2, [1, 0, 2]]  # every other triangle of a strip runs the other way
    return faces


def _skin(container: Container, nodes: Nodes, index: Any) -> Skin:
    entry = container.item("skins", index)
    joints = np.array(entry["joints"], dtype=np.int64)
    if not len(joints) or joints.min() < 0 or joints.max() >= len(nodes.parents):
        raise bad_rig(container.path, f"skin {index} names a joint that is no node")
    matrices = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    if "inverseBindMatrices" in entry:
        stored = read_accessor(container, entry["inverseBindMatrices"], "MAT4").astype(np.float64)
        if len(stored) < len(joints):
            raise bad_rig(container.path, f"skin {index} has {len(stored)} matrices for {len(joints)} joints")
        matrices = stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    if not np.isfinite(matrices).all():
        raise bad_rig(container.path, f"skin {index} has an inverse bind matrix that is not finite")
    return Skin(joints, matrices)


def _bound(
    container: Container,
    attributes: dict[str, Any],
    skin: Skin | None,
    vertices: Doubles,
    faces: Indices,
    node: int,
) -> Piece:
    """Return a surface bound to the joints of a skin; stiff on its node if none of its vertices has weights.

    Exporters leave vertices that no joint moves without weights, or with NaN. Among others that have some,
    such a vertex moves as the nearest of those: stiff beside them it would pull a spike out of the surface.
    """
    if skin is None or not any(name.startswith("JOINTS_") for name in attributes):
        return _stiff(vertices, faces, node)
    joints, weights = _binding(container, attributes, len(vertices))
    lost = ~np.isfinite(weights).all(axis=1) | ~weights.any(axis=1)
    if lost.all():
        return _stiff(vertices, faces, node)
    if lost.any():
        # Without copies, with which trees of points degenerate.
        places, first = np.unique(vertices[~lost], axis=0, return_index=True)
        nearest = np.flatnonzero(~lost)[first[cKDTree(places).query(vertices[lost])[1]]]
        joints[lost], weights[lost] = joints[nearest], weights[nearest]
    if weights.min() < 0:
        raise bad_rig(container.path, "a weight is negative")
    # Some exporters leave any number where the weight is 0.
    joints = np.where(weights > 0, joints, 0)
    if joints.max() >= len(skin.joints):
        raise bad_rig(
            container.path, f"a vertex is bound to joint {joints.max()} of {len(skin.joints)}, counted from 0"
        )
    total = weights.sum(axis=1, keepdims=True)
    wrong = np.abs(total - 1) > SUM_TOLERANCE
    if wrong.any():
        raise bad_rig(
            container.path,
            f"the weights of {wrong.sum()} vertices do not sum to 1, the first to {total[wrong][0]:.3g}",
        )
    return Piece(vertices, faces, node, skin, joints, weights / total)


def _stiff(vertices: Doubles, faces: Indices, node: int) -> Piece:
    count = len(vertices)
    return Piece(vertices, faces, node, None, np.zeros((count, 0), np.int64), np.zeros((count, 0)))


def _binding(container: Container, attributes: dict[str, Any], count: int) -> tuple[Indices, Doubles]:
    """Return the (V, K) joints and weights of vertices as they are stored, K a multiple of 4."""
    sets = range(sum(name.startswith("JOINTS_") for name in attributes))
    if len(sets) > MOST_SETS:
        raise bad_rig(
            container.path, f"a vertex is bound to {4 * len(sets)} joints; {4 * MOST_SETS} are enough"
        )
    joints = [read_accessor(container, attributes[f"JOINTS_{k}"], "VEC4").astype(np.int64) for k in sets]
    shares = [read_accessor(container, attributes[f"WEIGHTS_{k}"], "VEC4").astype(np.float64) for k in sets]
    index, weights = np.concatenate(joints, axis=1), np.concatenate(shares, axis=1)
    if index.shape != weights.shape or len(index) != count:
        raise bad_rig(container.path, f"{len(index)} joints and {len(weights)} weights for {count} vertices")
    return index, weights
