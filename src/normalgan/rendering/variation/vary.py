"""vary: another individual of a mesh, and its normals."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.variation.bending import in_turn
from normalgan.rendering.variation.draws import draw
from normalgan.rendering.variation.frame import find_frame
from normalgan.rendering.variation.steps import Object, steps
from normalgan.rendering.variation.variation import Variation

__all__ = ["LEAST_VOLUME", "cofactors", "vary"]

LEAST_VOLUME = 0.1
"""What shrinks the space about a vertex to less than this, or turns it over, is too strong."""


def vary(mesh: Mesh, variation: Variation, rng: np.random.Generator) -> Mesh:
    """Return an individual of a mesh: another one, but of its kind.

    Normals are carried over exactly, by the inverse transpose of the deformation's Jacobian, so what was
    a hard edge stays one. Where the deformation would turn the surface inside out, all strengths are
    halved until it does not.

    Args:
        mesh: the mesh; it is returned as it is if there is no strength.
        variation: how far individuals differ.
        rng: draws the individual; strengths change the amount of the difference, not its kind.
    """
    if variation.none():
        return mesh
    frame = find_frame(mesh)
    points = frame.inward(mesh.vertices.astype(np.float64))
    normals = mesh.normals.astype(np.float64) @ frame.axes.T
    thing = Object(points, normals, frame.areas, mesh.faces, frame.up)
    draws, amount = draw(rng), 1.0
    while True:
        moved, jacobian = in_turn(points, steps(thing, variation.times(amount), draws))
        turned = cofactors(jacobian)
        # A row times its cofactors is the determinant.
        volume = np.einsum("vc,vc->v", jacobian[:, 0], turned[:, 0])
        if volume.min() >= LEAST_VOLUME:
            break
        amount /= 2  # ends: without strength the Jacobian is the identity
    turned_normals = np.einsum("vij,vj->vi", turned, normals) @ frame.axes
    turned_normals /= np.linalg.norm(turned_normals, axis=1, keepdims=True)
    vertices = frame.outward(moved)
    vertices -= (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    vertices /= np.linalg.norm(vertices, axis=1).max()
    return Mesh(mesh.name, vertices.astype(np.float32), mesh.faces, turned_normals.astype(np.float32))


def cofactors(matrices: Doubles) -> Doubles:
    """Return the cofactors (V, 3, 3) of matrices (V, 3, 3): determinant times inverse transpose.

    >>> cofactors(np.diag([2.0, 1.0, 1.0])[None])[0].diagonal()
    array([1., 2., 2.])
    """
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
