"""Reading of rigs from glTF files: nodes, skins and bound surfaces, with checks."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.gltf.accessors import read_accessor
from normalgan.rendering.gltf.container import Container, bad_gltf, read_container, refusing_bad_gltf
from normalgan.rendering.gltf.scene import Nodes, read_nodes, read_primitives, shown_nodes
from normalgan.rendering.rigs.animations import read_clips
from normalgan.rendering.rigs.rig import BoundSurface, Rig, Skin

_MOST_SETS = 4
"""Maximum number of sets of four joints and weights per vertex."""
_SUM_TOLERANCE = 0.05
"""Tolerance for the sum of a vertex's weights; bytes are 0.008 off, and omitted weak joints slightly more."""


def read_rig(path: Path) -> Rig:
    """Return the rig in a glTF file.

    Skins follow the specification (glTF 2.0, section 3.7.3). Morph targets are ignored.

    Raises:
        InputError: if the file cannot be read, has no surface, or its rig is inconsistent.
    """
    with refusing_bad_gltf(path):
        container = read_container(path)
        nodes = read_nodes(container)
        pieces = tuple(
            piece for index in shown_nodes(container, nodes) for piece in _pieces(container, nodes, index)
        )
        clips = read_clips(container, nodes)
        names = tuple(str(entry.get("name", "")) for entry in container.tree.get("nodes", []))
    if not any(len(piece.faces) for piece in pieces):
        raise bad_gltf(path, "its scene shows no triangles")
    return Rig(nodes, pieces, clips, names)


def _pieces(container: Container, nodes: Nodes, index: int) -> list[BoundSurface]:
    entry = container.item("nodes", index)
    if "mesh" not in entry:
        return []
    skin = _skin(container, nodes, entry["skin"]) if "skin" in entry else None
    pieces = []
    for attributes, vertices, faces in read_primitives(container, entry["mesh"]):
        if not np.isfinite(vertices).all():
            raise bad_gltf(container.path, "a vertex has a coordinate that is not finite")
        pieces.append(_bound(container, attributes, skin, vertices, faces, index))
    return pieces


def _skin(container: Container, nodes: Nodes, index: Any) -> Skin:
    entry = container.item("skins", index)
    joints = np.array(entry["joints"], dtype=np.int64)
    if not len(joints) or joints.min() < 0 or joints.max() >= len(nodes.parents):
        raise bad_gltf(container.path, f"skin {index} names a joint that is not a node")
    matrices = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    if "inverseBindMatrices" in entry:
        stored = read_accessor(container, entry["inverseBindMatrices"], "MAT4").astype(np.float64)
        if len(stored) < len(joints):
            raise bad_gltf(
                container.path, f"skin {index} has {len(stored)} matrices for {len(joints)} joints"
            )
        matrices = stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    if not np.isfinite(matrices).all():
        raise bad_gltf(container.path, f"skin {index} has an inverse bind matrix that is not finite")
    return Skin(joints, matrices)


def _bound(
    container: Container,
    attributes: dict[str, Any],
    skin: Skin | None,
    vertices: Doubles,
    faces: Indices,
    node: int,
) -> BoundSurface:
    """Return a surface bound to the joints of a skin, or to its node if no vertex has weights.

    Exporters write no weights, or NaN, for vertices that no joint moves. If only some vertices have no
    weights, they move like the nearest vertex with weights, because rigid vertices would form spikes.
    """
    if skin is None or not any(name.startswith("JOINTS_") for name in attributes):
        return _stiff(vertices, faces, node)
    joints, weights = _binding(container, attributes, len(vertices))
    lost = ~np.isfinite(weights).all(axis=1) | ~weights.any(axis=1)
    if lost.all():
        return _stiff(vertices, faces, node)
    if lost.any():
        # Without duplicates, which would make a k-d tree degenerate.
        places, first = np.unique(vertices[~lost], axis=0, return_index=True)
        nearest = np.flatnonzero(~lost)[first[cKDTree(places).query(vertices[lost])[1]]]
        joints[lost], weights[lost] = joints[nearest], weights[nearest]
    if weights.min() < 0:
        raise bad_gltf(container.path, "a weight is negative")
    # Some exporters leave arbitrary numbers where the weight is 0.
    joints = np.where(weights > 0, joints, 0)
    if joints.max() >= len(skin.joints):
        raise bad_gltf(
            container.path, f"a vertex is bound to joint {joints.max()} of {len(skin.joints)}, counted from 0"
        )
    total = weights.sum(axis=1, keepdims=True)
    wrong = np.abs(total - 1) > _SUM_TOLERANCE
    if wrong.any():
        raise bad_gltf(
            container.path,
            f"the weights of {wrong.sum()} vertices do not sum to 1, the first to {total[wrong][0]:.3g}",
        )
    return BoundSurface(vertices, faces, node, skin, joints, weights / total)


def _stiff(vertices: Doubles, faces: Indices, node: int) -> BoundSurface:
    count = len(vertices)
    return BoundSurface(vertices, faces, node, None, np.zeros((count, 0), np.int64), np.zeros((count, 0)))


def _binding(container: Container, attributes: dict[str, Any], count: int) -> tuple[Indices, Doubles]:
    """Return the (V, K) joints and weights of vertices as stored; K is a multiple of 4."""
    sets = range(sum(name.startswith("JOINTS_") for name in attributes))
    if len(sets) > _MOST_SETS:
        raise bad_gltf(
            container.path, f"a vertex is bound to {4 * len(sets)} joints; {4 * _MOST_SETS} are enough"
        )
    joints = [read_accessor(container, attributes[f"JOINTS_{k}"], "VEC4").astype(np.int64) for k in sets]
    shares = [read_accessor(container, attributes[f"WEIGHTS_{k}"], "VEC4").astype(np.float64) for k in sets]
    index, weights = np.concatenate(joints, axis=1), np.concatenate(shares, axis=1)
    if index.shape != weights.shape or len(index) != count:
        raise bad_gltf(container.path, f"{len(index)} joints and {len(weights)} weights for {count} vertices")
    return index, weights
