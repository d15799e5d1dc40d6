"""Joints: limbs are found on a surface without a skeleton, and bend without tearing it."""

import numpy as np
import pytest
from mesh_shapes import angles, as_mesh, trimesh

from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.repair import weld
from normalgan.rendering.variation import Variation, vary
from normalgan.rendering.variation.joints import Joint, find_limb_joints

BENT = Variation().times(0.0)


def limbs() -> Mesh:
    """Return a ball with four thin limbs that end at ±0.9 along x, and side by side at -0.9 along y."""
    from skimage.measure import marching_cubes

    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 90)] * 3, indexing="ij"), axis=-1)
    distance = np.linalg.norm(grid, axis=-1) - 0.3
    for end in [(0.9, 0.1, 0), (-0.9, 0.1, 0), (0.25, -0.9, 0), (-0.25, -0.9, 0)]:
        tip = np.array(end)
        share = np.clip((grid @ tip) / (tip @ tip), 0, 1)[..., None]
        distance = np.minimum(distance, np.linalg.norm(grid - share * tip, axis=-1) - 0.07)
    vertices, faces, *_ = marching_cubes(distance, 0.0, spacing=(2 / 89,) * 3)
    return as_mesh("limbs", *weld(vertices - 1.0, faces[:, ::-1]))


def joints(mesh: Mesh, seed: int = 0) -> list[Joint]:
    return find_limb_joints(mesh.vertices.astype(np.float64), mesh.faces, np.random.default_rng(seed))


def test_each_limb_has_joints_whose_direction_is_that_of_the_limb() -> None:
    found = joints(limbs())
    ways = {tuple(np.sign(np.round(joint.centre, 1))[:2]) for joint in found}
    assert {(1.0, 0.0), (-1.0, 0.0)} <= {(x, 0.0) for x, _ in ways}
    assert 4 <= len(found) <= 8
    for joint in found:
        limb = joint.centre / np.linalg.norm(joint.centre)
        assert limb @ joint.outward > 0.95


@pytest.mark.parametrize("seed", range(4))
def test_limbs_bend_and_the_normals_stay_those_of_the_surface(seed: int) -> None:
    mesh = limbs()
    one = vary(mesh, Variation(**{**vars(BENT), "joints": 70.0}), np.random.default_rng(seed))
    assert np.abs(one.vertices - mesh.vertices).max() > 0.1
    anew = as_mesh("", one.vertices, one.faces)
    assert np.percentile(angles(one.normals, anew.normals), 99) < 15
    before, after = (
        trimesh.Trimesh(m.vertices, m.faces, process=False).edges_unique_length for m in (mesh, one)
    )
    assert np.max(after / before) < 4  # nothing tears


def test_a_bend_says_how_it_turns_space() -> None:
    joint = Joint(np.zeros(3), np.array([1.0, 0, 0]), 0.4, np.ones(60, bool), np.ones(60, bool))
    points = np.random.default_rng(0).uniform(-0.3, 0.3, (60, 3))
    axis = np.array([0.0, 0.6, 0.8])

    def moved(to: Doubles) -> Doubles:
        return joint.bend(to, axis, 0.9)[0]

    _, jacobian = joint.bend(points, axis, 0.9)
    for direction in np.eye(3):
        step = (moved(points + 1e-6 * direction) - moved(points - 1e-6 * direction)) / 2e-6
        np.testing.assert_allclose(jacobian @ direction, step, atol=1e-6)


def test_a_mesh_without_limbs_is_not_bent() -> None:
    ball = trimesh.creation.icosphere(3)
    assert joints(as_mesh("ball", ball.vertices, ball.faces)) == []


def test_clothes_move_with_the_limb_that_they_cover() -> None:
    body = limbs()
    skin = len(body.vertices)
    sleeve = np.unique(body.faces[(body.vertices[:, 0] > 0.5)[body.faces].all(axis=1)])
    faces = body.faces[np.isin(body.faces, sleeve).all(axis=1)]
    dressed = Mesh(
        "dressed",
        np.concatenate([body.vertices, body.vertices + 0.01 * body.normals]),
        np.concatenate([body.faces, faces + skin]),
        np.concatenate([body.normals, body.normals]),
    )
    one = vary(dressed, Variation(**{**vars(BENT), "joints": 70.0}), np.random.default_rng(1))
    assert np.linalg.norm(one.vertices[sleeve] - dressed.vertices[sleeve], axis=1).max() > 0.1
    assert np.linalg.norm(one.vertices[sleeve] - one.vertices[sleeve + skin], axis=1).max() < 0.03
