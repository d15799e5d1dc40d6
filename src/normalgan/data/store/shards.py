"""Shards: rendered samples in Zarr arrays, a few dozen per object, with checksums for all bytes."""

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
from normalgan.data.store.fsspec_storage import ObjectFolder
from normalgan.data.store.sample_layout import Layout, Shard, array_names, blank, chunk_path, encode, metadata
from normalgan.data.store.zarr_store import ObjectStore
from normalgan.errors import InputError
from normalgan.files.json_files import encode_json
from normalgan.rendering.samples import Sample

ZARR = "samples.zarr"
"""The folder of the arrays."""
_FAILED = "failed"
"""The folder for the reasons of failed meshes, in ``failed/<split>/<shard>.json``."""


class ShardedSamples:
    """The stored samples of one split, written shard by shard and read one by one.

    In the folder, ``samples.zarr/<split>/`` holds the Zarr 3 arrays ``sketch`` (N, H, W), ``normal`` (N,
    H, W, 3), ``mask`` (N, H, W) and, if the samples have any, ``hints`` (N, H, W, 4). They use the
    sharding codec with one sample per inner chunk, each with a CRC-32C. Any Zarr reader can open them.
    ``done/<split>/<shard>.json`` holds the length and SHA-256 of a shard's objects and is written last. A
    shard without it is unfinished. ``failed/<split>/<shard>.json`` lists meshes that could not be
    rendered. Their samples are blank and are skipped when reading.

    Args:
        url: folder of the data set.
        split: split of the samples, such as ``train``.
        layout: layout of the split.
        left_out: names of meshes with samples to skip.
        make: function that creates a shard found to be unfinished or damaged on reading; None raises an
            error instead.
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
        self._storage = ObjectFolder(url)
        self._opened: tuple[int, dict[str, Any]] | None = None
        self._trusted: set[int] = set()

    def __len__(self) -> int:
        return len(self._places)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}  # each process opens its own arrays

    @property
    def local(self) -> bool:
        """Whether the folder is on a disk of this machine."""
        return self._storage.local

    @property
    def makes(self) -> bool:
        """Whether missing shards are created on reading."""
        return self._make is not None

    @cached_property
    def _places(self) -> Indices:
        """The index in the layout of each sample that is not skipped."""
        meshes = [number for number, mesh in enumerate(self.layout.meshes) if mesh not in self.left_out]
        views = self.layout.views
        return (np.array(meshes, np.int64)[:, None] * views + np.arange(views)).ravel()

    def name(self, index: int) -> str:
        """Return the name of a sample: mesh and view index, such as ``horse-0001/17``."""
        mesh, view = self.layout.mesh_and_view(int(self._places[index]))
        return f"{mesh}/{view}"

    def indices(self, shard: int) -> range:
        """Return the indices of the samples in a shard, possibly none."""
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
        """Return the indices of unfinished shards."""
        done = self._storage.names(f"done/{self.split}")
        return [s for s in range(self.layout.shards) if f"{s}.json" not in done]

    def lost(self) -> list[int]:
        """Return the indices of finished shards with a missing object, from a listing."""
        names = self._storage.names(f"{ZARR}/{self.split}")
        there = {f"{self.split}/{name}" for name in names}
        return [
            shard for shard in self.finished() if not _paths(self.split, shard, self.layout.hints) <= there
        ]

    def verify(self) -> list[int]:
        """Return the indices of finished shards with changed bytes."""
        return damaged(self._storage, self.split, self.finished())

    def failures(self) -> dict[int, dict[str, str]]:
        """Return the reasons for failed meshes by shard and by name.

        Raises:
            InputError: if a file with these reasons is damaged.
        """
        notes = _read_failures(self._storage, self.split)
        found = {number: reasons for number, reasons in notes.items() if reasons is not None}
        if lost := notes.keys() - found.keys():
            raise self._trouble(min(lost))
        return found

    def unexplained(self) -> list[int]:
        """Return the indices of shards with a damaged file on failed meshes."""
        notes = _read_failures(self._storage, self.split)
        return [number for number, why in notes.items() if why is None and number < self.layout.shards]

    def finished(self) -> list[int]:
        """Return the indices of finished shards."""
        return sorted(set(range(self.layout.shards)) - set(self.missing()))

    def read(self, index: int) -> Sample:
        """Return a sample.

        Raises:
            IndexError: if there are fewer samples.
            InputError: if the shard is unfinished or damaged and cannot be rebuilt now.
        """
        if not 0 <= index < len(self):
            raise IndexError(f"sample {index} of {len(self)}")
        place = int(self._places[index])
        return Sample(**self._select_or_make(place // self.layout.per_shard, place))

    def is_blank(self, index: int) -> bool:
        """Return whether a sample is a placeholder, because its mesh could not be rendered."""
        place = int(self._places[index])
        note = self._storage.read(f"{_FAILED}/{self.split}/{place // self.layout.per_shard}.json")
        return note is not None and self.layout.mesh_and_view(place)[0] in (_reasons(note) or {})

    def read_shard(self, shard: int) -> dict[str, NDArray[Any]]:
        """Return the stacked samples of a shard by array name. Raises the errors of `read`."""
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
        """Check once that a shard is finished and its files have the recorded lengths."""
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
        if self._opened is None or self._opened[0] != os.getpid():  # for forked DataLoader workers
            group = zarr.open_group(ObjectStore(self._storage / ZARR), path=self.split, mode="r")
            self._opened = os.getpid(), {name: group[name] for name in array_names(self.layout.hints)}
        return self._opened[1]


def write_shard(
    storage: ObjectFolder, shard: Shard, samples: Sequence[Sample], failed: Mapping[str, str] | None = None
) -> None:
    """Write all samples of a shard, then mark it as finished; the same samples give the same bytes.

    Args:
        storage: folder of the data set.
        shard: shard to write.
        samples: one sample per position, blank for failed meshes.
        failed: reasons for failed meshes of the shard, by name.

    Raises:
        ValueError: if number or size of the samples differ from those of the shard.
        InputError: if the disk is full or not writable.
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
        storage.write(
            f"{note}.json", encode_json({mesh: failed[mesh] for mesh in shard.meshes if mesh in failed})
        )
    else:
        storage.delete(f"{note}.json")
        storage.delete(f"{note}.txt")
    sums = {path: [len(content), _digest(content)] for path, content in objects.items()}
    storage.write(shard.marker, encode_json(sums))


def write_traces(storage: ObjectFolder, shard: Shard, traces: Mapping[str, str]) -> str:
    """Write the tracebacks of failed meshes, given by name, and return the path within the cache."""
    path = f"{_FAILED}/{shard.split}/{shard.number}.txt"
    storage.write(path, "\n".join(f"{name}:\n{trace}" for name, trace in traces.items()).encode())
    return f"{storage.url.rstrip('/').rpartition('/')[2]}/{path}"


def _read_failures(storage: ObjectFolder, split: str) -> dict[int, dict[str, str] | None]:
    """Return the reasons for failed meshes of a split by shard and by name; None for a damaged file.

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


def _read_sums(storage: ObjectFolder, split: str, number: int) -> dict[str, tuple[int, str]] | None:
    """Return length and SHA-256 of a shard's objects by path, or None if the shard is unfinished."""
    try:
        found = json.loads(storage.read(f"done/{split}/{number}.json") or b"")
        sums = {path: (int(size), str(digest)) for path, (size, digest) in found.items()}
    except (ValueError, TypeError, AttributeError):
        return None
    return sums if set(sums) in [_paths(split, number, hints) for hints in (False, True)] else None


def _paths(split: str, number: int, hints: bool) -> set[str]:
    """Return the paths of a shard's objects within the folder of arrays."""
    return {chunk_path(split, name, number) for name in array_names(hints)}


def _same_bytes(storage: ObjectFolder, sums: Mapping[str, tuple[int, str]]) -> bool:
    """Return whether all objects of a shard match their recorded lengths and hashes."""
    found = {path: storage.read(f"{ZARR}/{path}") for path in sums}
    return all(c is not None and (len(c), _digest(c)) == sums[p] for p, c in found.items())


def damaged(storage: ObjectFolder, split: str, numbers: Sequence[int]) -> list[int]:
    """Return the indices of the given shards with changed bytes."""
    sums = {number: _read_sums(storage, split, number) for number in numbers}
    return [number for number, known in sums.items() if known is None or not _same_bytes(storage, known)]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _same_json(a: bytes, b: bytes) -> bool:
    try:
        return bool(json.loads(a) == json.loads(b))
    except ValueError:
        return False
