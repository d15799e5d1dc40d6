import pickle

import pytest
from toys import Counted, Octahedron

from normalgan.data.loading.mesh_cache import MeshCache
from normalgan.errors import InputError
from normalgan.rendering.mesh import Mesh

BYTES = 6 * 12 + 8 * 12 + 6 * 12
"""An octahedron's: vertices, faces, normals."""


def cached(count: int, limit: int) -> tuple[MeshCache, list[str]]:
    loads: list[str] = []
    return MeshCache([Counted(str(i), loads) for i in range(count)], limit), loads


def test_what_was_used_last_stays() -> None:
    meshes, loads = cached(4, limit=2 * BYTES)
    for number in (0, 1, 0, 2, 0, 1):
        assert meshes.take(number).name == str(number)
    assert loads == ["0", "1", "2", "1"]


@pytest.mark.parametrize(("limit", "kept"), [(0, 1), (BYTES - 1, 1), (3 * BYTES + 1, 3), (100 * BYTES, 7)])
def test_the_bound_is_kept(limit: int, kept: int) -> None:
    meshes, _ = cached(7, limit)
    for number in range(7):
        meshes.take(number)
        assert meshes.bytes == BYTES * len(meshes) <= max(limit, BYTES)
    assert len(meshes) == kept


def test_a_worker_starts_with_an_empty_cache() -> None:
    meshes = MeshCache([Octahedron("a")], limit=10 * BYTES)
    meshes.take(0)
    handed = pickle.loads(pickle.dumps(meshes))
    assert (len(handed), handed.bytes, len(meshes)) == (0, 0, 1)
    assert handed.take(0).name == "a"


def test_what_is_no_mesh_is_refused_before_it_is_kept() -> None:
    class Empty(Octahedron):
        def load(self) -> Mesh:
            return None  # type: ignore[return-value]

    meshes = MeshCache([Empty("a")], limit=BYTES)
    with pytest.raises(InputError, match="its load gave NoneType"):
        meshes.take(0)
    assert len(meshes) == meshes.bytes == 0
