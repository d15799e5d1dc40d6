"""Samples rendered during training, with new views in each epoch and nothing stored on disk."""

from collections import OrderedDict
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import torch
from torch.utils.data import Dataset, DistributedSampler

from normalgan.data.jobs.tasks import error_text
from normalgan.data.loading.items import Item, SampleError, to_item
from normalgan.data.loading.order import ViewIndex, order_of_epoch
from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.store.sample_layout import array_names
from normalgan.errors import FOREIGN_ERRORS
from normalgan.rendering.mesh import Mesh, check_mesh


class StreamDataset(Dataset[Item]):
    """Renders samples on request, identical to stored samples of the same mesh and view.

    The only state is a cache of meshes, so any process can render any sample at any time.

    Args:
        sources: usable meshes.
        views: number of views per mesh and epoch.
        recipe: recipe of the samples.
        memory: maximum memory for cached meshes per process, in bytes.
    """

    def __init__(self, sources: Sequence[Loadable], views: int, recipe: SampleRecipe, memory: int) -> None:
        self.views = views
        self.recipe = recipe
        self.mesh_cache = MeshCache(sources, memory)

    def __len__(self) -> int:
        """Return the number of samples per epoch."""
        return len(self.mesh_cache.sources) * self.views

    def __getitem__(self, index: int | ViewIndex) -> Item:
        """Return the sample of a view or, for an integer, of the first epoch in the order of the shards.

        Raises:
            SampleError: if the sample cannot be created; the message names the mesh.
        """
        if not isinstance(index, ViewIndex):
            index = ViewIndex(*divmod(range(len(self))[index], self.views))
        name = self.mesh_cache.sources[index.mesh].name
        try:
            sample = self.recipe.render(self.mesh_cache.take(index.mesh), index.view)
        except FOREIGN_ERRORS as error:  # a renderer or style may raise anything
            raise SampleError(
                f"view {index.view} of {name} cannot be rendered: {error_text(error)}"
            ) from error
        parts = array_names(self.recipe.hints)
        arrays = {part: torch.from_numpy(getattr(sample, part)) for part in parts}
        return to_item(arrays, f"{name}/{index.view}")


class FreshViews(DistributedSampler[ViewIndex]):
    """The views of the current epoch for process ``rank``, from 0; no view is repeated in another epoch.

    All processes get the same number of full batches, and each may leave out up to one batch per epoch. If
    there is less than a full batch for each process, all samples are used, and some are repeated.
    """

    def __init__(
        self, dataset: StreamDataset, seed: int, batch_size: int, replicas: int = 1, rank: int = 0
    ) -> None:
        super().__init__(dataset, num_replicas=replicas, rank=rank, seed=seed)
        self.samples = dataset
        self.batch_size = batch_size

    def __len__(self) -> int:
        total = len(self.samples)
        rounds = total // (self.batch_size * self.num_replicas)
        return rounds * self.batch_size or -(-total // self.num_replicas)

    def __iter__(self) -> Iterator[ViewIndex]:
        size, replicas, views = self.batch_size, self.num_replicas, self.samples.views
        meshes = len(self.samples.mesh_cache.sources)
        order = order_of_epoch(meshes, views, self.epoch, self.seed, size, replicas)
        if len(self.samples) < size * replicas:
            few = list(order)
            return (few[i % len(few)] for i in range(self.rank, len(self) * replicas, replicas))
        ours = (index for i, index in enumerate(order) if i // size % replicas == self.rank)
        return islice(ours, len(self))


class MeshCache:
    """Loads meshes, and keeps the most recently used ones; each process has its own cache.

    Args:
        sources: sources of the meshes.
        limit: maximum total size of their arrays in bytes; the last mesh is always kept.
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
        }  # without the meshes, so a worker starts with an empty cache

    def take(self, number: int) -> Mesh:
        """Return the mesh at an index.

        Raises:
            InputError: if the mesh cannot be used.
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
