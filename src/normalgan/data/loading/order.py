"""Order of samples from remote shards and of meshes that are rendered during training."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from torch.utils.data import Sampler

from normalgan.data.store.shards import ShardedSamples
from normalgan.seeds import derive_seed

VIEWS_AT_ONCE = 16
"""Number of views of a mesh that are rendered close together, before the mesh may leave the cache."""

BATCHES_PER_CYCLE = 24
"""Number of batches until the same meshes return; most numbers of workers divide it."""

ABREAST = 64
"""Number of shards shuffled together; with 32 samples per shard, batches are drawn from 2048 samples."""


class ViewIndex(NamedTuple):
    """A sample to render, as sent to a worker.

    Args:
        mesh: index of the mesh.
        view: index of the view, unique across epochs.
    """

    mesh: int
    view: int


def order_of_epoch(
    meshes: int, views: int, epoch: int, seed: int, batch_size: int, replicas: int = 1
) -> Iterator[ViewIndex]:
    """Yield views ``epoch * views`` to ``(epoch + 1) * views - 1`` of each mesh, shuffled.

    Loading a mesh takes as long as rendering a dozen views, so its views should not be scattered over the
    epoch. On the other hand, a batch should show many meshes. The views of each mesh are therefore split
    into groups, and the groups are shuffled. A row holds one view of each of the next
    ``BATCHES_PER_CYCLE * replicas * batch_size`` groups. The next row holds another view of the same groups
    in the same order, and so on until the groups are used up. Each sample of a batch thus comes from a
    different group, and the same meshes return every ``BATCHES_PER_CYCLE`` batches.

    A DataLoader distributes batches to its workers in turn. If the number of workers divides
    ``BATCHES_PER_CYCLE``, the batches with the same meshes all go to one worker, which loads a mesh once for
    a whole group. The order itself does not depend on the number of workers.

    Args:
        meshes: number of meshes.
        views: number of views per mesh and epoch.
        epoch: index of the epoch, from 0.
        seed: random seed, which changes the order but not the samples.
        batch_size: number of samples in a batch.
        replicas: number of training processes, each of which trains on every n-th batch.
    """
    parts = -(-views // VIEWS_AT_ONCE)
    groups = np.random.default_rng(derive_seed("order", seed, epoch)).permutation(meshes * parts)
    abreast = BATCHES_PER_CYCLE * replicas * batch_size
    for start in range(0, len(groups), abreast):
        mesh, part = np.divmod(groups[start : start + abreast], parts)
        # Groups with an extra view come first, so that the columns stay aligned.
        place = np.argsort(part >= (views % parts or parts), kind="stable")
        mesh, part = mesh[place], part[place]
        for offset in range(0, views, parts):
            view = offset + part
            for m, v in zip(mesh[view < views].tolist(), view[view < views].tolist(), strict=True):
                yield ViewIndex(m, epoch * views + v)


def spread(total: int, count: int) -> list[int]:
    """Return ``count`` evenly spaced indices of ``total`` samples, or all indices if there are fewer.

    >>> spread(10, 3)
    [0, 4, 9]
    >>> spread(2, 5)
    [0, 1]
    """
    if total <= count:
        return list(range(total))
    return [round(i * (total - 1) / max(count - 1, 1)) for i in range(count)]


class ShardOrder(Sampler[int]):
    """The order of an epoch for process ``rank``, from 0, of several training processes.

    In a fully random order, a batch of 8 samples reads 8 shards, which a limited cache drops before their
    other samples are needed. Shards are therefore shuffled and distributed to the processes, and each
    process shuffles the samples of `ABREAST` shards at a time. The order depends only on seed and epoch.
    All processes get the same number of samples. If shards do not divide evenly, some samples are repeated
    and some are left out of the epoch.
    """

    def __init__(self, store: ShardedSamples, replicas: int, rank: int, seed: int) -> None:
        self.store = store
        self.replicas = replicas
        self.rank = rank
        self.seed = seed
        self.epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Set the next epoch."""
        self.epoch = epoch

    def __len__(self) -> int:
        return (len(self.store) + self.replicas - 1) // self.replicas

    def __iter__(self) -> Iterator[int]:
        rng = np.random.default_rng(derive_seed("shards", self.seed, self.epoch))
        shards = [shard for shard in range(self.store.layout.shards) if self.store.indices(shard)]
        order = rng.permutation(shards)
        rng = np.random.default_rng(derive_seed("within shards", self.seed, self.epoch, self.rank))
        mine = np.resize(order, -(-len(order) // self.replicas) * self.replicas)[self.rank :: self.replicas]
        left = len(self)
        while left:  # shards differ in length, so a process with fewer samples repeats them
            for start in range(0, len(mine), ABREAST):
                parts = [list(self.store.indices(int(shard))) for shard in mine[start : start + ABREAST]]
                for index in rng.permutation(np.concatenate(parts).astype(np.int64))[:left].tolist():
                    left -= 1
                    yield index
