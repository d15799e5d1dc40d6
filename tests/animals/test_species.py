"""Species: sound bodies that look where they should."""

import pickle

import numpy as np
import pytest
from sound import check_closed, coarse

from normalgan.animals import GROUPS, SPECIES, Animal
from normalgan.rendering.mesh import Mesh


def area_normals(mesh: Mesh) -> np.ndarray:
    """Vertex normals from the faces alone, as an independent reference."""
    corners = mesh.vertices.astype(float)[mesh.faces]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros(mesh.vertices.shape)
    for corner in range(3):
        np.add.at(total, mesh.faces[:, corner], faces)
    unit: np.ndarray = total / np.linalg.norm(total, axis=1, keepdims=True)
    return unit


@pytest.mark.parametrize("species", [names[0] for names in GROUPS.values()])
def test_a_species_of_each_group_is_one_closed_body(species: str) -> None:
    mesh = coarse(species, 1, SPECIES[species].poses[0])
    check_closed(mesh)
    assert mesh.vertices.dtype == np.float32
    assert mesh.faces.dtype == np.int32
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)
    assert np.mean(np.einsum("ij,ij->i", mesh.normals, area_normals(mesh))) > 0.97


@pytest.mark.slow
def test_every_species_is_that_of_its_seed() -> None:
    for species, plan in SPECIES.items():
        first, again, other = (
            pickle.dumps(plan.grow(plan.poses[0], np.random.default_rng(seed))) for seed in (1, 1, 2)
        )
        assert first == again, species
        assert first != other, species


@pytest.mark.parametrize("species", ["giraffe", "shark", "spider"])
def test_a_whole_animal_has_as_many_faces_as_promised(species: str) -> None:
    mesh = Animal(species, 1).load()
    check_closed(mesh)
    assert 15_000 <= len(mesh.faces) <= 45_000
    assert np.mean(np.einsum("ij,ij->i", mesh.normals, area_normals(mesh)) > 0.8) > 0.99


@pytest.mark.slow
@pytest.mark.parametrize("species", SPECIES)
def test_every_pose_of_every_species_is_sound(species: str) -> None:
    for pose in SPECIES[species].poses:
        check_closed(coarse(species, 3, pose))


@pytest.mark.slow
@pytest.mark.parametrize("species", [names[-1] for names in GROUPS.values()])
def test_a_species_of_each_group_is_sound_with_all_its_faces(species: str) -> None:
    mesh = Animal(species, 3, SPECIES[species].poses[-1]).load()
    check_closed(mesh)
    assert 10_000 <= len(mesh.faces) <= 45_000


def test_heads_are_at_plus_x() -> None:
    giants = [coarse(name, 2, "stand").vertices for name in ("sauropod", "heron", "tyrannosaur")]
    for vertices in giants:
        assert vertices[np.argmax(vertices[:, 0]), 1] > 0.1  # beak, jaws or nose: before and above all else
    shark = coarse("shark", 1, "glide").vertices  # its tail fin is tall and thin, its head is not
    ends = [shark[shark[:, 0] * sign > 0.85] for sign in (1, -1)]
    assert np.ptp(ends[0][:, 1]) < 0.5 * np.ptp(ends[1][:, 1])
