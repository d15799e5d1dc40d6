"""vary: a random variant of a mesh, and its normals."""

from dataclasses import replace

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.variation.bending import in_turn
from normalgan.rendering.variation.draws import draw
from normalgan.rendering.variation.frame import find_frame
from normalgan.rendering.variation.joints import find_joints
from normalgan.rendering.variation.steps import Object, steps
from normalgan.rendering.variation.variation import Variation

__all__ = ["LEAST_VOLUME", "cofactors", "vary"]

LEAST_VOLUME = 0.1
"""A change that shrinks the space around a vertex to less than this, or inverts it, is too strong."""


def vary(mesh: Mesh, variation: Variation, rng: np.random.Generator) -> Mesh:
    """Return an individual of a mesh: a different individual of the same kind.

    Normals are transformed exactly, by the inverse transpose of the deformation's Jacobian, so hard edges
    stay hard. Where the deformation would turn the surface inside out, all strengths are halved until it does
    not.

    Args:
        mesh: the mesh; returned unchanged if all strengths are 0.
        variation: how far individuals differ.
        rng: draws the individual; strengths change the amount of the difference, not its kind.
    """
    if variation.none():
        return mesh
    limbs, lean = rng.spawn(2)
    if variation.joints:
        mesh = _bend_limbs(mesh, np.deg2rad(variation.joints), limbs)
    frame = find_frame(mesh)
    points = frame.inward(mesh.vertices.astype(np.float64))
    normals = mesh.normals.astype(np.float64) @ frame.axes.T
    thing = Object(points, normals, frame.areas, mesh.faces, frame.up)
    draws, amount = draw(rng), 1.0
    while True:
        moved, jacobian = in_turn(points, steps(thing, variation.times(amount), draws))
        turned = cofactors(jacobian)
        if _holds(jacobian, turned):
            break
        amount /= 2  # ends: without strength the Jacobian is the identity
    turned_normals = np.einsum("vij,vj->vi", turned, normals) @ frame.axes
    turned_normals /= np.linalg.norm(turned_normals, axis=1, keepdims=True)
    vertices = frame.outward(moved)
    if variation.tilt:
        turn = _lean(np.deg2rad(variation.tilt), lean)
        vertices, turned_normals = vertices @ turn.T, turned_normals @ turn.T
    vertices -= (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    vertices /= np.linalg.norm(vertices, axis=1).max()
    return Mesh(mesh.name, vertices.astype(np.float32), mesh.faces, turned_normals.astype(np.float32))


def _bend_limbs(mesh: Mesh, most: float, rng: np.random.Generator) -> Mesh:
    """Return the mesh with the joints of its limbs turned by up to ``most`` radians, each about any axis."""
    points, normals = mesh.vertices.astype(np.float64), mesh.normals.astype(np.float64)
    for joint in find_joints(points, mesh.faces, rng):
        axis = np.cross(joint.outward, rng.standard_normal(3))
        axis /= np.linalg.norm(axis)
        angle = float(rng.uniform(-most, most))
        moved, jacobian = joint.bend(points, axis, angle)
        turned = cofactors(jacobian)
        if _holds(jacobian, turned):
            points, normals = moved, np.einsum("vij,vj->vi", turned, normals)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return replace(mesh, vertices=points.astype(np.float32), normals=normals.astype(np.float32))


def _holds(jacobian: Doubles, turned: Doubles) -> bool:
    """Return whether a deformation leaves enough space about each vertex; ``turned`` has its cofactors."""
    volume = np.einsum("vc,vc->v", jacobian[:, 0], turned[:, 0])  # a row times its cofactors: the determinant
    return bool(volume.min() >= LEAST_VOLUME)


def _lean(most: float, rng: np.random.Generator) -> Doubles:
    """Return a rotation (3, 3) about a level axis by up to ``most`` radians; small angles are likelier."""
    from scipy.spatial.transform import Rotation  # half a second: only when a mesh is varied

    heading = rng.uniform(0.0, 2 * np.pi)
    angle = most * rng.uniform() ** 3
    axis = np.array([np.cos(heading), 0.0, np.sin(heading)])
    return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix())


def cofactors(matrices: Doubles) -> Doubles:
    """Return the cofactors (V, 3, 3) of matrices (V, 3, 3): determinant times inverse transpose.

    >>> cofactors(np.diag([2.0, 1.0, 1.0])[None])[0].diagonal()
    array([1., 2., 2.])
    """
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
