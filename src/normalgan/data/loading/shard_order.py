"""ShardOrder: random order over a remote store, shard by shard, so that each is fetched once."""

from collections.abc import Iterator

import numpy as np
from torch.utils.data import Sampler

from normalgan.data.store.shards import ShardedSamples
from normalgan.seeds import derive_seed

__all__ = ["ABREAST", "ShardOrder"]

ABREAST = 64
"""Shards whose samples are mixed: at 32 a shard, a batch is drawn from 2048 samples."""


class ShardOrder(Sampler[int]):
    """The order of an epoch for one of several processes that train side by side.

    In a fully random order a batch of 8 touches 8 shards, and a limited cache has dropped them before their
    other samples come. So shards are shuffled and shared among the processes, and each process shuffles the
    samples of `ABREAST` shards at a time. The order depends on seed and epoch alone. All processes have
    equally many samples; if shards do not divide evenly, some samples come twice and some not in this epoch.

    Args:
        store: the samples.
        replicas: how many processes train.
        rank: which one this is, from 0.
        seed: of the order.
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
        while left:  # shards differ in length: who has had all of a short share begins anew
            for start in range(0, len(mine), ABREAST):
                parts = [list(self.store.indices(int(shard))) for shard in mine[start : start + ABREAST]]
                for index in rng.permutation(np.concatenate(parts).astype(np.int64))[:left].tolist():
                    left -= 1
                    yield index
