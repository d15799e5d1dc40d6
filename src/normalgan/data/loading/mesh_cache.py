"""MeshCache: the meshes that a process used last, within a memory limit."""

from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

from normalgan.data.recipe import Loadable
from normalgan.rendering.checks import check_mesh
from normalgan.rendering.mesh import Mesh

__all__ = ["MeshCache"]


class MeshCache:
    """Loads meshes, and keeps those used last; each process fills a mesh_cache of its own.

    Args:
        sources: where the meshes come from.
        limit: bytes that their arrays may take together; the one used last stays, however large it is.
    """

    def __init__(self, sources: Sequence[Loadable], limit: int) -> None:
        self.sources = sources
        self.limit = limit
        self.bytes = 0
        self._meshes: OrderedDict[int, Mesh] = OrderedDict()

    def __len__(self) -> int:
        return len(self._meshes)

    def __getstate__(self) -> dict[str, Any]:
        return {
            **self.__dict__,
            "bytes": 0,
            "_meshes": OrderedDict(),
        }  # not what it holds: a worker starts empty

    def take(self, number: int) -> Mesh:
        """Return the mesh of this number.

        Raises:
            InputError: if it cannot be used.
        """
        mesh = self._meshes.pop(number, None)
        if mesh is None:
            mesh = check_mesh(self.sources[number].load())
            self.bytes += _bytes(mesh)
        self._meshes[number] = mesh
        while self.bytes > self.limit and len(self) > 1:
            _, oldest = self._meshes.popitem(last=False)
            self.bytes -= _bytes(oldest)
        return mesh


def _bytes(mesh: Mesh) -> int:
    return mesh.vertices.nbytes + mesh.faces.nbytes + mesh.normals.nbytes
