"""Order: the order of samples from remote shards and from meshes rendered during training."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from torch.utils.data import Sampler

from normalgan.data.store.shards import ShardedSamples
from normalgan.seeds import derive_seed

__all__ = [
    "ABREAST",
    "BATCHES_PER_CYCLE",
    "VIEWS_AT_ONCE",
    "ShardOrder",
    "ViewIndex",
    "order_of_epoch",
    "spread",
]

VIEWS_AT_ONCE = 16
"""Views of a mesh that are rendered close together; afterwards it may be forgotten."""

BATCHES_PER_CYCLE = 24
"""Batches in a row before the first one's meshes return: a number that most numbers of workers divide."""

ABREAST = 64
"""Shards whose samples are mixed: at 32 a shard, a batch is drawn from 2048 samples."""


class ViewIndex(NamedTuple):
    """A sample to render: everything that a worker must know.

    Args:
        mesh: number of the mesh.
        view: number of the view, which no other epoch has.
    """

    mesh: int
    view: int


def order_of_epoch(
    meshes: int, views: int, epoch: int, seed: int, batch_size: int, replicas: int = 1
) -> Iterator[ViewIndex]:
    """Yield every mesh's views ``epoch * views`` to ``(epoch + 1) * views - 1``, shuffled.

    Loading a mesh takes as long as rendering a dozen views, so its views should not be scattered over the
    epoch; but a batch should show many meshes. So the views of each mesh are cut into groups, and the groups
    are shuffled. A row holds one view of each of the next ``BATCHES_PER_CYCLE * replicas * batch_size``
    groups; the next row another view of the same groups in the same order, until they are used up and the
    next groups come. So a batch shows as many groups as it has samples, its neighbours show others, and the
    same meshes return every ``BATCHES_PER_CYCLE`` batches. A DataLoader deals batches out to its workers in
    rotation: if their number divides ``BATCHES_PER_CYCLE``, these batches all go to one worker, and a mesh is
    loaded once for a whole group.

    The order does not depend on the number of workers.

    Args:
        meshes: how many there are.
        views: views of each mesh an epoch.
        epoch: from 0.
        seed: a different seed changes the order, not the samples.
        batch_size: samples in a batch.
        replicas: processes that train side by side, each on every n-th batch.
    """
    parts = -(-views // VIEWS_AT_ONCE)
    groups = np.random.default_rng(derive_seed("order", seed, epoch)).permutation(meshes * parts)
    abreast = BATCHES_PER_CYCLE * replicas * batch_size
    for start in range(0, len(groups), abreast):
        mesh, part = np.divmod(groups[start : start + abreast], parts)
        # Groups with one view more come first, so that the columns stay aligned.
        place = np.argsort(part >= (views % parts or parts), kind="stable")
        mesh, part = mesh[place], part[place]
        for offset in range(0, views, parts):
            view = offset + part
            for m, v in zip(mesh[view < views].tolist(), view[view < views].tolist(), strict=True):
                yield ViewIndex(m, epoch * views + v)


def spread(total: int, count: int) -> list[int]:
    """Return ``count`` positions spread evenly over ``total`` samples, or all of them if there are fewer.

    >>> spread(10, 3)
    [0, 4, 9]
    >>> spread(2, 5)
    [0, 1]
    """
    if total <= count:
        return list(range(total))
    return [round(i * (total - 1) / max(count - 1, 1)) for i in range(count)]


class ShardOrder(Sampler[int]):
    """The order of an epoch for process ``rank``, from 0, of several that train side by side.

    In a fully random order a batch of 8 touches 8 shards, and a limited cache has dropped them before their
    other samples come. So shards are shuffled and shared among the processes, and each process shuffles the
    samples of `ABREAST` shards at a time. The order depends only on seed and epoch. All processes have
    equally many samples; if shards do not divide evenly, some samples come twice and some not in this epoch.
    """

    def __init__(self, store: ShardedSamples, replicas: int, rank: int, seed: int) -> None:
        self.store = store
        self.replicas = replicas
        self.rank = rank
        self.seed = seed
        self.epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Say which epoch is next."""
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
        while left:  # shards differ in length, so a process with a short share repeats it
            for start in range(0, len(mine), ABREAST):
                parts = [list(self.store.indices(int(shard))) for shard in mine[start : start + ABREAST]]
                for index in rng.permutation(np.concatenate(parts).astype(np.int64))[:left].tolist():
                    left -= 1
                    yield index
