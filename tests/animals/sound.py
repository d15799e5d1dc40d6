"""What every mesh of every species must be; for the tests beside this file."""

import numpy as np
import pytest
import trimesh

from normalgan.animals import SPECIES
from normalgan.animals.meshing import to_mesh
from normalgan.rendering.mesh import Mesh

COARSE = 6_000  # faces of the quick tests


def coarse(species: str, seed: int, pose: str | None = None) -> Mesh:
    """Return one individual with fewer faces than usual: at that size thin parts would break off first."""
    return to_mesh(f"{species} {pose}", SPECIES[species].grow(pose, np.random.default_rng(seed)), COARSE)


def check_closed(mesh: Mesh) -> trimesh.Trimesh:
    """Check that the mesh is one closed body of unit radius, and return it."""
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert body.is_watertight, mesh.name
    assert body.body_count == 1, mesh.name
    assert body.volume > 0, mesh.name  # so the faces are counter-clockwise seen from outside
    assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(1, abs=1e-5)
    return body
