"""What every mesh of every species must be; for the tests beside this file."""

import os
import pickle

import numpy as np
import pytest
import trimesh

from normalgan.animals import SPECIES, Animal
from normalgan.animals.meshing import to_mesh
from normalgan.rendering.mesh import Mesh

COARSE = 6_000  # faces of the quick tests
# Individuals of each species at full size, a second each; try 12 after a change to how animals are made.
FULL_SIZE = range(int(os.environ.get("NORMALGAN_ANIMALS", "2")))


def coarse(species: str, seed: int, pose: str | None = None) -> Mesh:
    """Return one individual with fewer faces than usual: at that size thin parts would break off first."""
    return to_mesh(species, SPECIES[species].grow(pose, np.random.default_rng(seed)), COARSE)


def check_closed(mesh: Mesh) -> trimesh.Trimesh:
    """Check that the mesh is one closed body of unit radius, and return it."""
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert body.is_watertight, mesh.name
    assert body.body_count == 1, mesh.name
    assert body.volume > 0, mesh.name  # so the faces are counter-clockwise seen from outside
    assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(1, abs=1e-5)
    return body


def check_individuals(species: str) -> None:
    """Check that two seeds in one pose are two closed bodies, and one seed twice the same parts."""
    pose = SPECIES[species].poses[0]
    one, two = (check_closed(coarse(species, seed, pose)) for seed in (1, 2))
    assert abs(one.volume - two.volume) > 1e-4 * one.volume
    # That the same parts are the same mesh is no matter of the species; test_animal.py asks it.
    first, again = (pickle.dumps(SPECIES[species].grow(pose, np.random.default_rng(1))) for _ in range(2))
    assert first == again


def check_full_size(animal: Animal) -> None:
    """Check an animal at the number of faces that training sees."""
    mesh = animal.load()
    check_closed(mesh)
    assert 15_000 <= len(mesh.faces) <= 45_000, f"{animal.name}: {len(mesh.faces)}"
