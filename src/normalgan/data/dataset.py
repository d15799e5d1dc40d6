"""SampleDataset: the samples of one split as tensors, of the stored types uint8, float16 and bool."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import Dataset

from normalgan.data.loading.items import Item, SampleError, to_item
from normalgan.data.store.sample_layout import ARRAYS, array_names
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError

__all__ = ["SampleDataset", "bytes_per_sample"]


class SampleDataset(Dataset[Item]):
    """Samples of one split, from memory if they fit, otherwise from the store one by one.

    DataLoader workers, forked or spawned, share the samples in memory; each opens the store itself. While a
    split is unfinished, each process keeps the samples that it has read.

    Args:
        store: where they lie.
        memory: bytes that may be used to hold the split; a sample of 256 pixels a side takes 0.5 MB.
        processes: number of processes that read an unfinished split in parallel and share the memory.
        substitute: whether the next sample replaces one that could not be made. Such a sample
            otherwise has an empty mask, which changes no metric.

    Raises:
        InputError: if it is held in memory and a shard is damaged, or is unfinished in a store that makes
            none. Otherwise reading raises it.
    """

    def __init__(
        self,
        store: ShardedSamples,
        memory: int = 2 * 1024**3,
        processes: int = 1,
        substitute: bool = False,
    ) -> None:
        self.store = store
        self.substitute = substitute
        self._held: dict[str, Tensor] | None = None
        self._recent: dict[int, Item] = {}
        self._room = 0
        each = bytes_per_sample(store.layout.size, store.layout.hints)
        if store.makes and store.missing():
            self._room = memory // (each * processes)
        elif len(store) * each <= memory:
            self._held = _read_all(store)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_recent": {}}  # without what it has read: a worker starts empty

    @property
    def distant(self) -> bool:
        """Whether samples come from another machine."""
        return self._held is None and not self.store.local

    def __len__(self) -> int:
        return len(self.store)

    def __getitem__(self, index: int) -> Item:
        index = range(len(self))[index]  # as a list: from the end if negative, IndexError if beyond
        for step in range(len(self)):
            place = (index + step) % len(self)
            item = self._kept(place)
            if not self.substitute or item["mask"].any() or not self.store.is_blank(place):
                return item
        raise SampleError(f"none of the {len(self)} samples of {self.store.split} can be used.")

    def _kept(self, index: int) -> Item:
        if index in self._recent:
            return self._recent[index]
        item = self._read(index)
        if len(self._recent) < self._room:
            self._recent[index] = item
        return item

    def _read(self, index: int) -> Item:
        name = self.store.name(index)
        if self._held is not None:
            return to_item({part: held[index] for part, held in self._held.items()}, name)
        try:
            sample = self.store.read(index)
        except InputError as error:
            raise SampleError(str(error)) from error
        parts = array_names(self.store.layout.hints)
        return to_item({part: torch.from_numpy(np.array(getattr(sample, part))) for part in parts}, name)


def bytes_per_sample(size: int, hints: bool = False) -> int:
    """Return the memory that one sample of ``size`` pixels a side takes.

    >>> bytes_per_sample(256)
    524288
    """
    arrays = [ARRAYS[name] for name in array_names(hints)]
    return size * size * sum(np.dtype(kind).itemsize * int(np.prod(tail)) for kind, tail in arrays)


def _read_all(store: ShardedSamples) -> dict[str, Tensor]:
    """Return the arrays of a split as tensors, which processes share when they are handed over."""
    size, count = store.layout.size, len(store)
    held: dict[str, NDArray[Any]] = {
        name: np.empty((count, size, size, *ARRAYS[name][1]), ARRAYS[name][0])
        for name in array_names(store.layout.hints)
    }
    for shard in range(store.layout.shards):
        indices = store.indices(shard)
        for name, part in store.read_shard(shard).items():
            held[name][indices.start : indices.stop] = part
    return {name: torch.from_numpy(array) for name, array in held.items()}
