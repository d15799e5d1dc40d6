"""Birds, fish, reptiles and dinosaurs: sound bodies that look where they should."""

import zlib

import numpy as np
import pytest
import trimesh
from sound import check_closed, check_full_size

from normalgan.animals import GROUPS, SPECIES, Animal
from normalgan.animals.meshing import to_mesh
from normalgan.rendering.mesh import Mesh

OURS = [(group, name) for group in ("birds", "fish", "reptiles", "dinosaurs") for name in GROUPS[group]]
NAMES = [name for _, name in OURS]
COARSE = 5_000  # faces: the shape is the same, the grid is not, and a test takes a fifth of the time


def coarse(species: str, seed: int, pose: str | None = None) -> Mesh:
    rng = np.random.default_rng([zlib.crc32(species.encode()), seed])
    return to_mesh(species, SPECIES[species].grow(pose, rng), COARSE)


def solid(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


@pytest.mark.parametrize("group", ["birds", "fish", "reptiles", "dinosaurs"])
def test_a_group_has_at_least_four_species_and_each_several_poses(group: str) -> None:
    assert len(GROUPS[group]) >= 4
    assert all(len(SPECIES[name].poses) >= 2 for name in GROUPS[group])


@pytest.mark.parametrize("species", NAMES)
def test_every_species_is_one_closed_body(species: str) -> None:
    check_closed(coarse(species, 1))


@pytest.mark.parametrize("group", ["birds", "fish"])
def test_the_same_number_is_the_same_animal_and_another_is_not(group: str) -> None:
    species = GROUPS[group][0]
    pose = SPECIES[species].poses[0]
    first, again, other = (coarse(species, seed, pose) for seed in (1, 1, 2))
    assert first.vertices.tobytes() == again.vertices.tobytes()
    assert first.faces.tobytes() == again.faces.tobytes()
    assert abs(solid(first).volume - solid(other).volume) > 1e-3 * solid(first).volume


@pytest.mark.parametrize("species", ["owl", "shark"])
def test_a_whole_animal_has_as_many_faces_as_promised(species: str) -> None:
    check_full_size(Animal(species, 1))


def test_wings_spread_are_wider_than_wings_folded() -> None:
    wide, narrow = (np.ptp(coarse("eagle", 1, pose).vertices, axis=0) for pose in ("soar", "stand"))
    assert wide[2] / wide[0] > 1.2
    assert narrow[2] / narrow[1] < 0.7


def test_heads_are_at_plus_x() -> None:
    giants = [coarse(name, 1, "stand").vertices for name in ("sauropod", "heron", "tyrannosaur")]
    for vertices in giants:
        assert vertices[np.argmax(vertices[:, 0]), 1] > 0.1  # beak, jaws or nose: before and above all else
    shark = coarse("shark", 1, "glide").vertices  # its tail fin is tall and thin, its head is not
    ends = [shark[shark[:, 0] * sign > 0.85] for sign in (1, -1)]
    assert np.ptp(ends[0][:, 1]) < 0.5 * np.ptp(ends[1][:, 1])


@pytest.mark.parametrize("species", ["perch", "angelfish"])
def test_fish_that_glide_are_nearly_the_same_on_both_sides(species: str) -> None:
    straight, bent = (coarse(species, 3, pose).vertices for pose in ("glide", "turn"))
    middle = [float(np.abs(v[np.argmin(v[:, 0]), 2] - v[np.argmax(v[:, 0]), 2])) for v in (straight, bent)]
    assert middle[0] < 0.2 * middle[1]


@pytest.mark.slow
@pytest.mark.parametrize("species", NAMES)
def test_every_pose_of_every_species_is_sound(species: str) -> None:
    for pose in SPECIES[species].poses:
        check_full_size(Animal(species, 3, pose))
