"""Loaders: from samples to batches, in this process or in workers."""

import multiprocessing
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import torch
from torch.utils.data import DataLoader, Dataset, DistributedSampler, Sampler

from normalgan.data.dataset import SampleDataset
from normalgan.data.jobs.workers import check_main_guard, leave_signals_to_parent, one_thread_each
from normalgan.data.loading.items import Item, collate_decoded
from normalgan.data.loading.order import ShardOrder
from normalgan.data.loading.stream import FreshViews, StreamDataset

__all__ = ["EqualShare", "Loaders"]

_Samples = SampleDataset | StreamDataset


class _DeferredLoader(DataLoader[Item]):
    """A DataLoader that starts its workers when the first batch is requested.

    Lightning makes the iterator of a resumed run before it sets the sampler's epoch, so that workers would
    start with samples of the previous epoch. Rendering workers are spawned, with one thread each: a process
    forked after an OpenGL context exists hangs when it renders, and one forked from a process with threads,
    as torch has, may wait for a lock for ever.

    A checkpoint saved within an epoch stores the number of batches so far. A resumed run continues after
    them.
    """

    _given = 0
    _skipped = 0

    def __iter__(self) -> Any:
        """Yield the batches of the epoch that the sampler is set to by then."""
        context = self.multiprocessing_context
        if self.num_workers and (context or multiprocessing).get_start_method() != "fork":
            check_main_guard()
        with one_thread_each():
            batches = super().__iter__()
        skipped, self._skipped = self._skipped, 0
        for number, batch in enumerate(batches, 1):
            if number > skipped:
                self._given = number
                yield batch

    def state_dict(self) -> dict[str, int]:
        """Return the number of the epoch's batches so far."""
        return {"given": self._given}

    def load_state_dict(self, state: dict[str, int]) -> None:
        """In the next epoch, skip the batches that the stopped run has used."""
        self._skipped = self._given = max(int(state["given"]), 0)


@dataclass(frozen=True)
class Loaders:
    """Makes the loaders of one of several processes that train side by side.

    Args:
        batch_size: samples in a batch.
        workers: processes that load or render; 0 for none besides this one.
        replicas: how many processes train.
        rank: which one this is, from 0.
        decoded: whether batches are decoded here; a trainer decodes them on its device, as stored samples
            take a quarter of the bytes.
    """

    batch_size: int
    workers: int
    replicas: int = 1
    rank: int = 0
    decoded: bool = True

    def shuffled(self, dataset: _Samples, seed: int) -> DataLoader[Item]:
        """Return a loader of this process's share, in an order that depends only on seed and epoch."""
        sampler: FreshViews | ShardOrder | DistributedSampler[Item]
        if isinstance(dataset, StreamDataset):
            sampler = FreshViews(dataset, seed, self.batch_size, self.replicas, self.rank)
        elif dataset.distant:
            sampler = ShardOrder(dataset.store, self.replicas, self.rank, seed)
        else:
            # For a single process too: its order does not come from global state, which a resumed run
            # does not have.
            sampler = DistributedSampler(dataset, self.replicas, self.rank, shuffle=True, seed=seed)
        whole = len(sampler) >= self.batch_size  # a last batch of one sample would upset batch norm
        return self._loader(dataset, sampler, isinstance(dataset, StreamDataset), whole)

    def in_order(self, dataset: SampleDataset) -> DataLoader[Item]:
        """Return a loader of this process's share, in order, for measuring."""
        if self.replicas == 1:
            return self._loader(dataset)
        share = EqualShare(dataset, self.replicas, self.rank)
        return self._loader(share, share.in_order())

    def chosen(self, dataset: _Samples, indices: Sequence[int]) -> DataLoader[Item]:
        """Return a loader of some samples, the same ones for every process."""
        return self._loader(dataset, indices, isinstance(dataset, StreamDataset))

    def _loader(
        self,
        dataset: Dataset[Item],
        sampler: Sampler[Any] | Sequence[int] | None = None,
        renders: bool = False,
        drop_last: bool = False,
    ) -> DataLoader[Item]:
        return _DeferredLoader(
            dataset,
            batch_size=self.batch_size,
            sampler=sampler,
            num_workers=self.workers,
            drop_last=drop_last,
            persistent_workers=self.workers > 0,
            pin_memory=torch.cuda.is_available(),
            collate_fn=collate_decoded if self.decoded else None,
            multiprocessing_context="spawn" if renders and self.workers else None,
            worker_init_fn=_prepare_worker if renders else None,
        )


class EqualShare(Dataset[Item]):
    """The share of process ``rank``, from 0, in a split: every n-th sample, the same number for each process.

    If the samples do not divide evenly, shares are padded with a sample whose mask is empty, which changes no
    metric, so several processes measure exactly what one does. Padding with repeated samples, as Lightning
    does, would change metrics. With unequal shares a process would wait for ever, because the networks'
    buffers are exchanged with every batch.
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
        """Return a sampler of this share in order, of a class that Lightning does not replace."""
        return DistributedSampler(self, num_replicas=1, rank=0, shuffle=False)


def _prepare_worker(_: int) -> None:
    leave_signals_to_parent()
