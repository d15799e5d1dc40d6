"""Shares: which samples of a split each of several processes measures."""

from typing import Any

import torch
from torch.utils.data import Dataset, DistributedSampler

from normalgan.data.loading.items import Item

__all__ = ["EqualShare"]


class EqualShare(Dataset[Item]):
    """One process's share of a split: every n-th sample, and as many as every other process has.

    Where the samples do not divide, the last ones are filled up with a sample whose mask is empty, which
    changes no metric; so several processes measure exactly what one does. Filling up with samples that are
    measured twice, as Lightning does, would not; and shares of unlike length let a process wait forever
    for another, as the buffers of the networks are exchanged with every batch.

    Args:
        dataset: the split.
        replicas: how many processes there are.
        rank: which one this is, from 0.
    """

    def __init__(self, dataset: Dataset[Item], replicas: int, rank: int) -> None:
        self.dataset: Any = dataset  # it has a length
        self.replicas = replicas
        self.rank = rank

    def __len__(self) -> int:
        return (len(self.dataset) + self.replicas - 1) // self.replicas

    def __getitem__(self, index: int) -> Item:
        position = range(self.rank, len(self) * self.replicas, self.replicas)[index]
        if position < len(self.dataset):
            found: Item = self.dataset[position]
            return found
        item: Item = self.dataset[len(self.dataset) - 1]
        return {**item, "mask": torch.zeros_like(item["mask"])}

    def in_order(self) -> DistributedSampler[Item]:
        """Return the sampler of the whole share; of this class, or Lightning would share it out once more."""
        return DistributedSampler(self, num_replicas=1, rank=0, shuffle=False)
