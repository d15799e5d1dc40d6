"""Variation: individuals of a mesh are whole, of its kind, and drawn by number."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_shapes import MESHES, angles, as_mesh, blob, ellipsoid, needs_meshes, solid, trimesh

from normalgan.rendering.mesh import Mesh, MeshSource
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.repair import shade, weld
from normalgan.rendering.variation import Variation, Varied, vary
from normalgan.rendering.variation.frame import find_frame

NOTHING = Variation().times(0.0)
STRENGTHS = {name: strength for name, strength in vars(Variation(tilt=90.0)).items() if strength}


def individual(mesh: Mesh, variation: Variation, seed: int = 0) -> Mesh:
    return vary(mesh, variation, np.random.default_rng(seed))


def test_without_strength_it_is_the_mesh_itself() -> None:
    assert individual(blob(), NOTHING) is blob()
    assert individual(blob(), replace(NOTHING, asymmetry=0.9)) is blob()


@pytest.mark.parametrize("name", sorted(STRENGTHS.keys() - {"asymmetry"}))
def test_each_strength_alone_changes_the_shape_and_not_inside_out(name: str) -> None:
    alone = replace(NOTHING, asymmetry=0.5, **{name: STRENGTHS[name]})
    one = individual(blob(), alone, 2)
    assert np.abs(one.vertices - blob().vertices).max() > 0.005
    check_whole(one, blob())


def check_whole(one: Mesh, origin: Mesh) -> None:
    """Check what `Mesh` promises, and that the normals are those of the surface."""
    assert one.faces is origin.faces
    assert np.linalg.norm(one.vertices, axis=1).max() == pytest.approx(1, abs=1e-6)
    middle = (one.vertices.min(axis=0) + one.vertices.max(axis=0)) / 2
    np.testing.assert_allclose(middle, 0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(one.normals, axis=1), 1, atol=1e-6)
    assert solid(one).volume > 0
    anew = as_mesh("", one.vertices, one.faces)
    assert np.median(angles(one.normals, anew.normals)) < 2
    assert np.percentile(angles(one.normals, anew.normals), 99) < 15


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10_000), st.floats(0, 3.5))
def test_individuals_are_never_inside_out(seed: int, strength: float) -> None:
    wild = replace(Variation().times(strength), asymmetry=0.9)
    one = individual(blob(), wild, seed)
    facing = np.einsum("fc,fc->f", solid(one).face_normals, one.normals[one.faces[:, 0]])
    assert np.mean(facing > 0) > 0.99
    assert solid(one).volume > 0


def test_too_much_strength_is_halved_until_the_surface_holds() -> None:
    torn = replace(NOTHING, lattice=0.9)
    one = individual(blob(), torn, 3)
    for amount in (1.0, 0.5):
        with_less = individual(blob(), torn.times(amount), 3)
        np.testing.assert_array_equal(one.vertices, with_less.vertices)
    assert np.abs(one.vertices - individual(blob(), torn.times(0.02), 3).vertices).max() > 0.02


def test_a_flat_mesh_can_vary() -> None:
    box = trimesh.creation.box(extents=(1, 1, 1)).subdivide().subdivide()
    flat = as_mesh("flat", *weld(box.vertices * [1, 1, 0], box.faces))  # one square: weld drops the rest
    flat = replace(flat, vertices=flat.vertices / np.linalg.norm(flat.vertices, axis=1).max())
    for seed in range(3):
        one = individual(flat, replace(Variation(), lattice=0.2), seed)
        assert np.isfinite(one.vertices).all()
        assert np.isfinite(one.normals).all()


def test_normals_follow_exactly_where_the_surface_is_known() -> None:
    ball = ellipsoid(1, 1, 1, 4)
    one = individual(replace(ball, normals=ball.vertices), replace(NOTHING, scale=0.5), 1)
    half = np.ptp(one.vertices, axis=0) / 2
    assert np.ptp(half) > 0.1
    exact = one.vertices / half**2  # the gradient of an ellipsoid's equation
    assert angles(one.normals, exact).max() < 0.001


def test_hard_edges_stay_hard() -> None:
    box = trimesh.creation.box(extents=(1.6, 0.9, 0.5)).subdivide().subdivide().subdivide()
    vertices, faces, normals = shade(np.asarray(box.vertices), np.asarray(box.faces), 40.0)
    vertices /= np.linalg.norm(vertices, axis=1).max()
    mesh = Mesh("box", vertices.astype(np.float32), faces.astype(np.int32), normals.astype(np.float32))
    one = individual(mesh, replace(NOTHING, twist=60.0, bend=40.0, asymmetry=0.5), 2)
    flat = solid(one).face_normals
    for corner in range(3):
        assert angles(one.normals[one.faces[:, corner]], flat).max() < 8


def mirror_error(mesh: Mesh, origin: Mesh) -> float:
    """Return how far a mesh is from its mirror image, vertex for vertex as in a symmetric origin."""
    partner = solid(origin).kdtree.query(origin.vertices * [1, 1, -1])[1]
    return float(np.abs(mesh.vertices * [1, 1, -1] - mesh.vertices[partner]).max())


def test_a_symmetric_mesh_stays_symmetric_without_asymmetry() -> None:
    even = ellipsoid(1, 0.6, 0.35, 4)  # as the icosphere under it, its own mirror image
    assert mirror_error(even, even) < 1e-6
    assert mirror_error(individual(even, replace(Variation(), asymmetry=0.0)), even) < 1e-4
    assert mirror_error(individual(even, replace(Variation(), asymmetry=0.6)), even) > 0.02


@pytest.mark.parametrize("turn", [0.0, 30.0, 71.5])
def test_the_frame_finds_the_plane_of_symmetry(turn: float) -> None:
    body = trimesh.creation.icosphere(subdivisions=4).vertices * [1, 0.5, 0.3]
    body[:, 1] += 0.3 * body[:, 0] ** 2 + 0.2 * body[:, 0]  # a banana: one plane of symmetry
    matrix = trimesh.transformations.rotation_matrix(np.deg2rad(turn), [0, 1, 0])[:3, :3]
    mesh = as_mesh("", body @ matrix.T, trimesh.creation.icosphere(subdivisions=4).faces)
    frame = find_frame(mesh)
    assert frame.up == 1
    assert abs(frame.axes[2] @ matrix[:, 2]) > np.cos(np.deg2rad(1.0))
    assert frame.areas.sum() == pytest.approx(solid(mesh).area)


def test_an_individual_is_drawn_by_its_number() -> None:
    class Blob:
        name = "blob"

        def fingerprint(self) -> str:
            return "f"

        def load(self) -> Mesh:
            return blob()

    source: MeshSource = Blob()
    one, two = Varied(source, Variation(), 0), Varied(source, Variation(), 1)
    assert (one.name, two.name) == ("blob~0", "blob~1")
    assert one.load().name == "blob~0"
    np.testing.assert_array_equal(one.load().vertices, Varied(source, Variation(), 0).load().vertices)
    assert np.abs(one.load().vertices - two.load().vertices).max() > 0.02
    prints = {each.fingerprint() for each in (one, two, Varied(source, Variation(bend=3.0), 0))}
    assert len(prints) == 3


@needs_meshes
def test_real_animals_vary_without_a_fold() -> None:
    for name in ("Horse", "Fox"):
        origin = MeshFile(str(MESHES / "animals" / f"{name}.glb")).load()
        for seed in range(2):
            one = individual(origin, Variation(), seed)
            facing = np.einsum("fc,fc->f", solid(one).face_normals, one.normals[one.faces].mean(axis=1))
            before = np.einsum(
                "fc,fc->f", solid(origin).face_normals, origin.normals[origin.faces].mean(axis=1)
            )
            assert np.mean(facing > 0) > np.mean(before > 0) - 0.002
