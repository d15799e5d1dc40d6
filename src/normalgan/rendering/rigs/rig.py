"""Rig: a tree of nodes with bound pieces of surface, animation clips, and linear blend skinning."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.gltf.scene import Nodes


@dataclass(frozen=True)
class Skin:
    """The nodes that move a surface.

    Args:
        joints: (J,) indices of nodes.
        inverse_bind: (J, 4, 4) matrices from the surface's axes to those of the joint in the rest pose,
            for column vectors.
    """

    joints: Indices
    inverse_bind: Doubles


@dataclass(frozen=True)
class BoundSurface:
    """A surface that moves rigidly with a node, or bends with the joints of a skin.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices.
        node: index of the node that the surface is attached to.
        skin: skin that moves the surface instead of its node; None for a rigid surface.
        joints: (V, K) indices into the skin's joints.
        weights: (V, K) weights of the joints, which sum to 1.
    """

    vertices: Doubles
    faces: Indices
    node: int
    skin: Skin | None
    joints: Indices
    weights: Doubles


@dataclass(frozen=True)
class Track:
    """The animation of one property of one node.

    Args:
        node: index of the node.
        path: translation, rotation or scale.
        interpolation: LINEAR, STEP or CUBICSPLINE.
        times: (T,) ascending times in seconds.
        values: (T, 3, D) in-tangent, value and out-tangent at each time; the tangents are 0 unless the
            interpolation is CUBICSPLINE.
    """

    node: int
    path: str
    interpolation: str
    times: Doubles
    values: Doubles


@dataclass(frozen=True)
class Clip:
    """An animation: tracks that run together.

    Args:
        name: name in the file, empty if there is none.
        tracks: at most one track per node and property.
    """

    name: str
    tracks: tuple[Track, ...]

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time of all tracks, in seconds."""
        return (
            min(float(track.times[0]) for track in self.tracks),
            max(float(track.times[-1]) for track in self.tracks),
        )


@dataclass(frozen=True)
class Rig:
    """A surface that can be posed.

    Args:
        nodes: nodes of the scene.
        pieces: visible pieces of surface.
        clips: animations with at least one track.
        names: names of the nodes in the file; empty if there are none.
    """

    nodes: Nodes
    pieces: tuple[BoundSurface, ...]
    clips: tuple[Clip, ...]
    names: tuple[str, ...]


def posed_vertices(piece: BoundSurface, world: Doubles) -> Doubles:
    """Return the world positions (V, 3) of a piece's vertices, given the nodes' world matrices (N, 4, 4).

    They are ``x' = sum_k w_k J_k B_k x`` with the joint's world matrix J and inverse bind matrix B
    (Magnenat-Thalmann et al., "Joint-dependent local deformations for hand animation and object grasping",
    1988). The node of a skinned piece does not affect it (glTF 2.0, section 3.7.3.3).
    """
    points = np.concatenate([piece.vertices, np.ones((len(piece.vertices), 1))], axis=1)
    if piece.skin is None:
        return np.asarray(points @ world[piece.node, :3].T)
    matrices = (world[piece.skin.joints] @ piece.skin.inverse_bind)[:, :3]
    blended = np.einsum("vk,vkij->vij", piece.weights, matrices[piece.joints])
    return np.asarray(np.einsum("vij,vj->vi", blended, points))


def posed_surface(rig: Rig, world: Doubles) -> tuple[Doubles, Indices]:
    """Return the vertices (V, 3) and faces (F, 3) of the whole rig in world axes."""
    vertices, faces, start = [], [], 0
    for piece in rig.pieces:
        mirrored = piece.skin is None and np.linalg.det(world[piece.node, :3, :3]) < 0
        vertices.append(posed_vertices(piece, world))
        faces.append(start + (piece.faces[:, ::-1] if mirrored else piece.faces))
        start += len(piece.vertices)
    return np.concatenate(vertices), np.concatenate(faces)
