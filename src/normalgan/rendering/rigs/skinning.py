"""Linear blend skinning: vertex positions from node matrices."""

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.rigs.rig import Piece, Rig

__all__ = ["posed_surface", "posed_vertices"]


def posed_vertices(piece: Piece, world: Doubles) -> Doubles:
    """Return the (V, 3) places of a piece's vertices in the world.

    ``x' = sum_k w_k J_k B_k x`` with the joint's place J and its inverse bind matrix B (Magnenat-Thalmann
    et al., "Joint-dependent local deformations for hand animation and object grasping", 1988); the place
    of the node that a skinned piece hangs on does not matter (glTF 2.0, section 3.7.3.3).

    Args:
        piece: a surface.
        world: (N, 4, 4) from `world_matrices`.
    """
    points = np.concatenate([piece.vertices, np.ones((len(piece.vertices), 1))], axis=1)
    if piece.skin is None:
        return np.asarray(points @ world[piece.node, :3].T)
    matrices = (world[piece.skin.joints] @ piece.skin.inverse_bind)[:, :3]
    blended = np.einsum("vk,vkij->vij", piece.weights, matrices[piece.joints])
    return np.asarray(np.einsum("vij,vj->vi", blended, points))


def posed_surface(rig: Rig, world: Doubles) -> tuple[Doubles, Indices]:
    """Return the vertices (V, 3) and faces (F, 3) of the whole rig in the world."""
    vertices, faces, start = [], [], 0
    for piece in rig.pieces:
        mirrored = piece.skin is None and np.linalg.det(world[piece.node, :3, :3]) < 0
        vertices.append(posed_vertices(piece, world))
        faces.append(start + (piece.faces[:, ::-1] if mirrored else piece.faces))
        start += len(piece.vertices)
    return np.concatenate(vertices), np.concatenate(faces)
