"""Shards: rendered samples in Zarr arrays, a few dozen to an object, every byte of them checked."""

import hashlib
import json
import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from normalgan.data.layout import ARRAYS, Layout, chunk_path, encode, metadata
from normalgan.data.storage import Storage
from normalgan.errors import InputError
from normalgan.rendering.samples import Sample

_ZARR = "samples.zarr"


class ShardedSamples:
    """The stored samples of one split, to be written a shard at a time and read one by one.

    In the folder, ``samples.zarr/<split>/`` holds the Zarr 3 arrays ``sketch`` (N, H, W), ``normal``
    (N, H, W, 3) and ``mask`` (N, H, W) in the sharding codec, one sample to an inner chunk, each with its
    CRC-32C; any Zarr reader opens them. ``done/<split>/<shard>.json`` holds the length and SHA-256 of a
    shard's objects and is written last: what has none is not there yet.

    Args:
        url: the folder of the data set.
        split: which part of it, such as ``train``.
        layout: what lies where.
    """

    def __init__(self, url: str, split: str, layout: Layout) -> None:
        self.url, self.split, self.layout = url, split, layout
        self._storage = Storage(url)
        self._opened: tuple[int, dict[str, Any]] | None = None
        self._trusted: set[int] = set()

    def __len__(self) -> int:
        return len(self.layout)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}  # open arrays belong to the process

    def name(self, index: int) -> str:
        """Return what a sample is called: mesh and number of the view, such as ``horse-0001/17``."""
        mesh, view = self.mesh_and_view(index)
        return f"{mesh}/{view}"

    def mesh_and_view(self, index: int) -> tuple[str, int]:
        """Return the name of a sample's mesh and the number of the view of it."""
        return self.layout.meshes[index // self.layout.views], index % self.layout.views

    def meshes(self, shard: int) -> list[str]:
        """Return the names of the meshes that a shard has views of, in order."""
        return list(dict.fromkeys(self.mesh_and_view(index)[0] for index in self.layout.indices(shard)))

    def create(self) -> None:
        """Write the description of the arrays, unless it is there already."""
        for path, content in metadata(self.split, self.layout).items():
            known = self._storage.read(f"{_ZARR}/{path}")
            if known is None or not _same_json(known, content):
                self._storage.write(f"{_ZARR}/{path}", content)

    def missing(self) -> list[int]:
        """Return the shards that have not been finished."""
        return [s for s in range(self.layout.shards) if self._storage.size(self._marker(s)) is None]

    def verify(self) -> list[int]:
        """Return the finished shards whose objects are not, byte for byte, what was once written."""
        done = sorted(set(range(self.layout.shards)) - set(self.missing()))
        return [shard for shard in done if not self._intact(shard)]

    def write(self, shard: int, samples: Iterable[Sample]) -> None:
        """Write all samples of a shard, then mark it as finished; the same samples give the same bytes.

        Raises:
            ValueError: if the samples are not as many or not as large as the layout says.
            InputError: if the disk is full or may not be written to.
        """
        objects = encode(self.split, self.layout, shard, list(samples))
        self._storage.delete(self._marker(shard))
        for path, content in objects.items():
            self._storage.write(f"{_ZARR}/{path}", content)
        sums = {path: [len(content), _digest(content)] for path, content in objects.items()}
        self._storage.write(self._marker(shard), (json.dumps(sums, indent=1) + "\n").encode())

    def read(self, index: int) -> Sample:
        """Return one sample.

        Raises:
            IndexError: if there are fewer.
            InputError: if its shard is not finished or damaged.
        """
        if not 0 <= index < len(self):
            raise IndexError(f"sample {index} of {len(self)}")
        return Sample(**self._select(index // self.layout.per_shard, index))

    def read_shard(self, shard: int) -> dict[str, NDArray[Any]]:
        """Return a shard's samples stacked: ``sketch``, ``normal``, ``mask``. Raises as `read` does."""
        indices = self.layout.indices(shard)
        return self._select(shard, slice(indices.start, indices.stop))

    def _select(self, shard: int, selection: int | slice) -> dict[str, NDArray[Any]]:
        trouble = (
            f"shard {shard} of {self.split} in {self.url} is unfinished or damaged; "
            "render the data set again, which mends it."
        )
        # Zarr fills in zeros for an object that is gone, without a word.
        if shard not in self._trusted and not self._intact(shard, quick=True):
            raise InputError(trouble)
        self._trusted.add(shard)
        try:
            return {name: np.asarray(array[selection]) for name, array in self._arrays().items()}
        except (ValueError, RuntimeError, OSError) as error:  # checksum; decompression; disk
            raise InputError(trouble) from error

    def _arrays(self) -> dict[str, Any]:
        if self._opened is None or self._opened[0] != os.getpid():  # a forked DataLoader worker opens its own
            store = (self._storage / _ZARR).zarr_store()
            group = zarr.open_group(store, path=self.split, mode="r")
            self._opened = os.getpid(), {name: group[name] for name in ARRAYS}
        return self._opened[1]

    def _marker(self, shard: int) -> str:
        return f"done/{self.split}/{shard}.json"

    def _intact(self, shard: int, quick: bool = False) -> bool:
        marker = self._storage.read(self._marker(shard)) or b""
        try:
            sums = json.loads(marker)
            expected = {path: (int(size), str(digest)) for path, (size, digest) in sums.items()}
        except (ValueError, TypeError, AttributeError):
            return False
        if set(expected) != {f"{self.split}/{chunk_path(name, shard)}" for name in ARRAYS}:
            return False
        if quick:
            return all(self._storage.size(f"{_ZARR}/{p}") == size for p, (size, _) in expected.items())
        found = {path: self._storage.read(f"{_ZARR}/{path}") for path in expected}
        return all(c is not None and (len(c), _digest(c)) == expected[p] for p, c in found.items())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _same_json(a: bytes, b: bytes) -> bool:
    try:
        return bool(json.loads(a) == json.loads(b))
    except ValueError:
        return False
