"""Shards: rendered samples in Zarr arrays, a few dozen to an object, every byte of them checked."""

import hashlib
import json
import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from normalgan.arrays import Indices
from normalgan.data.store.fsspec_storage import Storage
from normalgan.data.store.sample_layout import Layout, Shard, array_names, blank, chunk_path, encode, metadata
from normalgan.data.store.zarr_store import ObjectStore
from normalgan.errors import InputError
from normalgan.rendering.samples import Sample

__all__ = ["ZARR", "ShardedSamples", "damaged", "write_shard", "write_traces"]

ZARR = "samples.zarr"
"""The folder of the arrays."""
_FAILED = "failed"
"""The folder that says which meshes could not be rendered, in ``failed/<split>/<shard>.json``."""


class ShardedSamples:
    """The stored samples of one split, to be written a shard at a time and read one by one.

    In the folder, ``samples.zarr/<split>/`` holds the Zarr 3 arrays ``sketch`` (N, H, W), ``normal``
    (N, H, W, 3), ``mask`` (N, H, W) and, if samples bring any, ``hints`` (N, H, W, 4) in the sharding codec,
    one sample to an inner chunk, each with its CRC-32C; any Zarr reader opens them.
    ``done/<split>/<shard>.json`` holds the length and SHA-256 of a shard's objects and is written last: a
    shard without it is unfinished. ``failed/<split>/<shard>.json`` says which meshes could not be rendered;
    their places are blank, and they are passed over when reading.

    Args:
        url: the folder of the data set.
        split: which part of it, such as ``train``.
        layout: what lies where.
        left_out: names of meshes whose samples are passed over.
        make: writes a shard that turns out to be unfinished or damaged when it is read; None raises instead.
    """

    def __init__(
        self,
        url: str,
        split: str,
        layout: Layout,
        left_out: Collection[str] = (),
        make: Callable[[Shard], None] | None = None,
    ) -> None:
        self.url, self.split, self.layout = url, split, layout
        self.left_out = frozenset(left_out)
        self._make = make
        self._storage = Storage(url)
        self._opened: tuple[int, dict[str, Any]] | None = None
        self._trusted: set[int] = set()

    def __len__(self) -> int:
        return len(self._places)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}  # open arrays belong to the process

    @property
    def local(self) -> bool:
        """Whether the folder is on a disk of this machine."""
        return self._storage.local

    @property
    def makes(self) -> bool:
        """Whether a shard that is missing is made when it is read."""
        return self._make is not None

    @cached_property
    def _places(self) -> Indices:
        """The place in the layout of each sample that is not passed over."""
        meshes = [number for number, mesh in enumerate(self.layout.meshes) if mesh not in self.left_out]
        views = self.layout.views
        return (np.array(meshes, np.int64)[:, None] * views + np.arange(views)).ravel()

    def name(self, index: int) -> str:
        """Return the name of a sample: mesh and number of the view, such as ``horse-0001/17``."""
        mesh, view = self.layout.mesh_and_view(int(self._places[index]))
        return f"{mesh}/{view}"

    def indices(self, shard: int) -> range:
        """Return the samples that lie in a shard; there may be none."""
        places = self.layout.indices(shard)
        start, stop = np.searchsorted(self._places, [places.start, places.stop])
        return range(int(start), int(stop))

    def create(self) -> None:
        """Write the arrays' metadata, unless it exists."""
        for path, content in metadata(self.split, self.layout).items():
            known = self._storage.read(f"{ZARR}/{path}")
            if known is None or not _same_json(known, content):
                self._storage.write(f"{ZARR}/{path}", content)

    def missing(self) -> list[int]:
        """Return the shards that have not been finished."""
        done = self._storage.names(f"done/{self.split}")
        return [s for s in range(self.layout.shards) if f"{s}.json" not in done]

    def lost(self) -> list[int]:
        """Return the finished shards with a missing object, from a listing."""
        names = self._storage.names(f"{ZARR}/{self.split}")
        there = {f"{self.split}/{name}" for name in names}
        return [
            shard for shard in self.finished() if not _paths(self.split, shard, self.layout.hints) <= there
        ]

    def verify(self) -> list[int]:
        """Return the finished shards whose bytes differ from those that were written."""
        return damaged(self._storage, self.split, self.finished())

    def failures(self) -> dict[int, dict[str, str]]:
        """Return why meshes could not be rendered: by shard, by name.

        Raises:
            InputError: if such a note is damaged.
        """
        notes = _read_failures(self._storage, self.split)
        found = {number: reasons for number, reasons in notes.items() if reasons is not None}
        if lost := notes.keys() - found.keys():
            raise self._trouble(min(lost))
        return found

    def unexplained(self) -> list[int]:
        """Return the shards whose note on failed meshes is damaged."""
        notes = _read_failures(self._storage, self.split)
        return [number for number, why in notes.items() if why is None and number < self.layout.shards]

    def finished(self) -> list[int]:
        """Return the shards that have been finished."""
        return sorted(set(range(self.layout.shards)) - set(self.missing()))

    def read(self, index: int) -> Sample:
        """Return one sample.

        Raises:
            IndexError: if there are fewer.
            InputError: if its shard is unfinished or damaged and cannot be rebuilt now.
        """
        if not 0 <= index < len(self):
            raise IndexError(f"sample {index} of {len(self)}")
        place = int(self._places[index])
        return Sample(**self._select_or_make(place // self.layout.per_shard, place))

    def is_blank(self, index: int) -> bool:
        """Whether a sample that was read is a placeholder, as its mesh could not be rendered."""
        place = int(self._places[index])
        note = self._storage.read(f"{_FAILED}/{self.split}/{place // self.layout.per_shard}.json")
        return note is not None and self.layout.mesh_and_view(place)[0] in (_reasons(note) or {})

    def read_shard(self, shard: int) -> dict[str, NDArray[Any]]:
        """Return the samples of a shard, stacked, by name of the array; raises as `read` does."""
        places = self.layout.indices(shard)
        stacked = self._select_or_make(shard, slice(places.start, places.stop))
        if not self.left_out:
            return stacked
        keep = [self.layout.mesh_and_view(place)[0] not in self.left_out for place in places]
        return {name: array[keep] for name, array in stacked.items()}

    def _select_or_make(self, shard: int, selection: int | slice) -> dict[str, NDArray[Any]]:
        try:
            return self._select(shard, selection)
        except InputError:
            if self._make is None:
                raise
        self._make(self.layout.shard(self.split, shard))
        return self._select(shard, selection)

    def _select(self, shard: int, selection: int | slice) -> dict[str, NDArray[Any]]:
        try:
            arrays = self._open()
            self._trust(shard)
            return {name: np.asarray(array[selection]) for name, array in arrays.items()}
        except InputError:
            raise
        except (ValueError, RuntimeError, OSError) as error:  # checksum; decompression
            raise self._trouble(shard) from error

    def _trust(self, shard: int) -> None:
        """Check once that a shard is finished and its files have their lengths."""
        if shard in self._trusted:
            return
        sums = _read_sums(self._storage, self.split, shard)
        if sums is None or any(self._storage.size(f"{ZARR}/{p}") != size for p, (size, _) in sums.items()):
            raise self._trouble(shard)
        self._trusted.add(shard)

    def _trouble(self, shard: int) -> InputError:
        return InputError(
            f"shard {shard} of {self.split} in {self.url} is unfinished or damaged; "
            "render the data set again to repair it."
        )

    def _open(self) -> dict[str, Any]:
        if self._opened is None or self._opened[0] != os.getpid():  # a forked DataLoader worker opens its own
            group = zarr.open_group(ObjectStore(self._storage / ZARR), path=self.split, mode="r")
            self._opened = os.getpid(), {name: group[name] for name in array_names(self.layout.hints)}
        return self._opened[1]


def write_shard(
    storage: Storage, shard: Shard, samples: Sequence[Sample], failed: Mapping[str, str] | None = None
) -> None:
    """Write all samples of a shard, then mark it as finished; the same samples give the same bytes.

    Args:
        storage: the folder of the data set.
        shard: number of the shard.
        samples: a sample for each place, a blank one for a mesh that failed.
        failed: why a mesh of the shard could not be rendered, by name.

    Raises:
        ValueError: if the samples are not as many or not as large as the shard says.
        InputError: if the disk is full or is not writable.
    """
    failed = failed or {}
    if len(samples) != len(shard):
        raise ValueError(f"shard {shard.number} takes {len(shard)} samples, not {len(samples)}")
    named = zip(shard.samples, samples, strict=True)
    kept = [blank(shard.size, shard.hints) if mesh in failed else sample for (mesh, _), sample in named]
    objects = encode(shard, kept)
    storage.delete(shard.marker)
    for path, content in objects.items():
        storage.write(f"{ZARR}/{path}", content)
    note = f"{_FAILED}/{shard.split}/{shard.number}"
    if failed:
        storage.write(f"{note}.json", _json({mesh: failed[mesh] for mesh in shard.meshes if mesh in failed}))
    else:
        storage.delete(f"{note}.json")
        storage.delete(f"{note}.txt")
    sums = {path: [len(content), _digest(content)] for path, content in objects.items()}
    storage.write(shard.marker, _json(sums))


def write_traces(storage: Storage, shard: Shard, traces: Mapping[str, str]) -> str:
    """Write the tracebacks of failed meshes, by name, and return the path within the cache."""
    path = f"{_FAILED}/{shard.split}/{shard.number}.txt"
    storage.write(path, "\n".join(f"{name}:\n{trace}" for name, trace in traces.items()).encode())
    return f"{storage.url.rstrip('/').rpartition('/')[2]}/{path}"


def _read_failures(storage: Storage, split: str) -> dict[int, dict[str, str] | None]:
    """Return why meshes of a split could not be rendered: by shard, by name; None for a damaged note.

    Files of other programs, such as file managers, are ignored.
    """
    folder = f"{_FAILED}/{split}"
    numbers = sorted(int(name[:-5]) for name in storage.names(folder) if re.fullmatch(r"\d{1,9}\.json", name))
    notes = {number: storage.read(f"{folder}/{number}.json") for number in numbers}
    return {number: _reasons(note) for number, note in notes.items() if note is not None}


def _reasons(note: bytes) -> dict[str, str] | None:
    try:
        found = json.loads(note)
    except (ValueError, RecursionError):
        return None
    whole = isinstance(found, dict) and found and all(isinstance(why, str) for why in found.values())
    return found if whole else None


def _read_sums(storage: Storage, split: str, number: int) -> dict[str, tuple[int, str]] | None:
    """Return length and SHA-256 of a shard's objects by path, or None if it is not finished."""
    try:
        found = json.loads(storage.read(f"done/{split}/{number}.json") or b"")
        sums = {path: (int(size), str(digest)) for path, (size, digest) in found.items()}
    except (ValueError, TypeError, AttributeError):
        return None
    return sums if set(sums) in [_paths(split, number, hints) for hints in (False, True)] else None


def _paths(split: str, number: int, hints: bool) -> set[str]:
    """Return the paths of a shard's objects in the folder of the arrays."""
    return {chunk_path(split, name, number) for name in array_names(hints)}


def _same_bytes(storage: Storage, sums: Mapping[str, tuple[int, str]]) -> bool:
    """Whether all objects of a shard have their recorded bytes."""
    found = {path: storage.read(f"{ZARR}/{path}") for path in sums}
    return all(c is not None and (len(c), _digest(c)) == sums[p] for p, c in found.items())


def damaged(storage: Storage, split: str, numbers: Sequence[int]) -> list[int]:
    """Return the shards whose bytes differ from those that were written."""
    sums = {number: _read_sums(storage, split, number) for number in numbers}
    return [number for number, known in sums.items() if known is None or not _same_bytes(storage, known)]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _json(content: Mapping[str, object]) -> bytes:
    return (json.dumps(content, indent=1) + "\n").encode()


def _same_json(a: bytes, b: bytes) -> bool:
    try:
        return bool(json.loads(a) == json.loads(b))
    except ValueError:
        return False
