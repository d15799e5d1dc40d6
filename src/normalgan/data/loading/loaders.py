"""Loaders: batches of samples, loaded in this process or in workers."""

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

_Samples = SampleDataset | StreamDataset


class _DeferredLoader(DataLoader[Item]):
    """A DataLoader that starts its workers when the first batch is requested.

    In a resumed run, Lightning creates the iterator before it sets the sampler's epoch, so workers would
    otherwise start with samples of the previous epoch. Rendering workers are spawned, with one thread
    each. A process that is forked after an OpenGL context was created hangs when it renders, and one that
    is forked from a process with threads, such as those of torch, may wait for a lock forever.

    A checkpoint saved within an epoch stores the number of batches so far, and a resumed run continues
    after them.
    """

    _given = 0
    _skipped = 0

    def __iter__(self) -> Any:
        """Yield the batches of the sampler's current epoch."""
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
        """Return the number of batches so far in the epoch."""
        return {"given": self._given}

    def load_state_dict(self, state: dict[str, int]) -> None:
        """Skip the batches in the next epoch that the stopped run has already used."""
        self._skipped = self._given = max(int(state["given"]), 0)


@dataclass(frozen=True)
class Loaders:
    """Creates the loaders for one of several training processes.

    Args:
        batch_size: number of samples in a batch.
        workers: number of processes that load or render; 0 to use only this process.
        replicas: number of training processes.
        rank: index of this process, from 0.
        decoded: whether batches are decoded here. A trainer decodes them on its device, because stored
            samples take a quarter of the bytes.
    """

    batch_size: int
    workers: int
    replicas: int = 1
    rank: int = 0
    decoded: bool = True

    def shuffled(self, dataset: _Samples, seed: int) -> DataLoader[Item]:
        """Return a loader of this process's part, in an order that depends only on seed and epoch."""
        sampler: FreshViews | ShardOrder | DistributedSampler[Item]
        if isinstance(dataset, StreamDataset):
            sampler = FreshViews(dataset, seed, self.batch_size, self.replicas, self.rank)
        elif dataset.distant:
            sampler = ShardOrder(dataset.store, self.replicas, self.rank, seed)
        else:
            # Also for a single process, because the order must not depend on global state, which a resumed
            # run does not have.
            sampler = DistributedSampler(dataset, self.replicas, self.rank, shuffle=True, seed=seed)
        whole = len(sampler) >= self.batch_size  # a last batch of one sample would upset batch norm
        return self._loader(dataset, sampler, isinstance(dataset, StreamDataset), whole)

    def in_order(self, dataset: SampleDataset) -> DataLoader[Item]:
        """Return a loader of this process's part in order, for validation and testing."""
        if self.replicas == 1:
            return self._loader(dataset)
        share = EqualShare(dataset, self.replicas, self.rank)
        return self._loader(share, share.in_order())

    def chosen(self, dataset: _Samples, indices: Sequence[int]) -> DataLoader[Item]:
        """Return a loader of the given samples, the same for all processes."""
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
    """The part of a split for process ``rank``, from 0: every n-th sample, equally many for each process.

    If the samples do not divide evenly, parts are padded with a sample with an empty mask, which does not
    affect metrics. Several processes therefore compute exactly the metrics of a single one. Padding with
    repeated samples, as in Lightning, would change metrics. Parts of unequal length would make a process
    wait forever, because the networks' buffers are exchanged with every batch.
    """

    def __init__(self, dataset: Dataset[Item], replicas: int, rank: int) -> None:
        self.dataset: Any = dataset  # the dataset has a length
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
        """Return a sampler for this part in order, of a class that Lightning does not replace."""
        return DistributedSampler(self, num_replicas=1, rank=0, shuffle=False)


def _prepare_worker(_: int) -> None:
    leave_signals_to_parent()
