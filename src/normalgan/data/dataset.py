"""SampleDataset: the samples of one split as tensors of the stored types uint8, float16 and bool."""

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


class SampleDataset(Dataset[Item]):
    """Samples of one split, read from memory if they fit, otherwise one by one from the store.

    DataLoader workers, forked or spawned, share the samples in memory, and each opens the store itself. As
    long as a split is unfinished, each process keeps the samples that it has read.

    Args:
        store: store of the samples.
        memory: maximum memory for the split in bytes; a 256-pixel sample takes 0.5 MB.
        processes: number of processes that read an unfinished split in parallel and share the memory.
        substitute: whether a sample that could not be created is replaced by the next one. Otherwise, such
            a sample has an empty mask, which does not affect metrics.

    Raises:
        InputError: if the split is held in memory and a shard is damaged, or is unfinished and cannot be
            created. For other splits, the error is raised on reading.
    """

    def __init__(
        self, store: ShardedSamples, memory: int = 2 * 1024**3, processes: int = 1, substitute: bool = False
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
        return {**self.__dict__, "_recent": {}}  # without the samples read so far, so a worker starts empty

    @property
    def distant(self) -> bool:
        """Whether the samples are read from another machine."""
        return self._held is None and not self.store.local

    def __len__(self) -> int:
        return len(self.store)

    def __getitem__(self, index: int) -> Item:
        index = range(len(self))[index]  # like a list, with negative indices and IndexError
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
    """Return the memory of a sample with ``size`` pixels per side.

    >>> bytes_per_sample(256)
    524288
    """
    arrays = [ARRAYS[name] for name in array_names(hints)]
    return size * size * sum(np.dtype(kind).itemsize * int(np.prod(tail)) for kind, tail in arrays)


def _read_all(store: ShardedSamples) -> dict[str, Tensor]:
    """Return the arrays of a split as tensors in shared memory."""
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
