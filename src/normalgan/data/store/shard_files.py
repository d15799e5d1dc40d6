"""The objects of a shard: how they are written, whether they are whole, what could not be rendered."""

import hashlib
import json
import re
from collections.abc import Mapping, Sequence

from normalgan.data.store.layout import Shard, array_names, blank, chunk_path, encode
from normalgan.data.store.storage import Storage
from normalgan.rendering.samples import Sample

__all__ = [
    "FAILED",
    "ZARR",
    "damaged",
    "paths",
    "read_failure",
    "read_failures",
    "read_sums",
    "same_bytes",
    "same_sizes",
    "write_shard",
]

ZARR = "samples.zarr"
"""The folder of the arrays."""

FAILED = "failed"
"""The folder that says which meshes could not be rendered: ``failed/<split>/<shard>.json``."""


def write_shard(
    storage: Storage, shard: Shard, samples: Sequence[Sample], failed: Mapping[str, str] | None = None
) -> None:
    """Write all samples of a shard, then mark it as finished; the same samples give the same bytes.

    Args:
        storage: the folder of the data set.
        shard: which one.
        samples: of each place; those of a mesh that failed are replaced by blank ones.
        failed: why a mesh of the shard could not be rendered, by name.

    Raises:
        ValueError: if the samples are not as many or not as large as the shard says.
        InputError: if the disk is full or may not be written to.
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
    note = f"{FAILED}/{shard.split}/{shard.number}.json"
    if failed:
        storage.write(note, _json({mesh: failed[mesh] for mesh in shard.meshes if mesh in failed}))
    else:
        storage.delete(note)
    sums = {path: [len(content), _digest(content)] for path, content in objects.items()}
    storage.write(shard.marker, _json(sums))


def read_failures(storage: Storage, split: str) -> dict[int, dict[str, str] | None]:
    """Return why meshes of a split could not be rendered: by shard, by name; None for a damaged note.

    Files that others leave in such a folder, as file managers do, are passed over.
    """
    folder = f"{FAILED}/{split}"
    numbers = sorted(int(name[:-5]) for name in storage.names(folder) if re.fullmatch(r"\d{1,9}\.json", name))
    notes = {number: storage.read(f"{folder}/{number}.json") for number in numbers}
    return {number: _reasons(note) for number, note in notes.items() if note is not None}


def read_failure(storage: Storage, split: str, number: int) -> dict[str, str] | None:
    """Return why meshes of one shard could not be rendered, by name; None if all could."""
    note = storage.read(f"{FAILED}/{split}/{number}.json")
    return None if note is None else _reasons(note)


def _reasons(note: bytes) -> dict[str, str] | None:
    try:
        found = json.loads(note)
    except (ValueError, RecursionError):
        return None
    whole = isinstance(found, dict) and found and all(isinstance(why, str) for why in found.values())
    return found if whole else None


def read_sums(storage: Storage, split: str, number: int) -> dict[str, tuple[int, str]] | None:
    """Return length and SHA-256 of a shard's objects by path, or None if it is not finished."""
    try:
        found = json.loads(storage.read(f"done/{split}/{number}.json") or b"")
        sums = {path: (int(size), str(digest)) for path, (size, digest) in found.items()}
    except (ValueError, TypeError, AttributeError):
        return None
    return sums if set(sums) in [paths(split, number, hints) for hints in (False, True)] else None


def paths(split: str, number: int, hints: bool) -> set[str]:
    """Return where a shard's objects lie in the folder of the arrays."""
    return {chunk_path(split, name, number) for name in array_names(hints)}


def same_sizes(storage: Storage, sums: Mapping[str, tuple[int, str]]) -> bool:
    """Whether all objects of a shard are there, and as long as they were."""
    return all(storage.size(f"{ZARR}/{path}") == size for path, (size, _) in sums.items())


def same_bytes(storage: Storage, sums: Mapping[str, tuple[int, str]]) -> bool:
    """Whether all objects of a shard are, byte for byte, what was once written."""
    found = {path: storage.read(f"{ZARR}/{path}") for path in sums}
    return all(c is not None and (len(c), _digest(c)) == sums[p] for p, c in found.items())


def damaged(storage: Storage, split: str, numbers: Sequence[int]) -> list[int]:
    """Return those of some shards that are not, byte for byte, what was once written."""
    sums = {number: read_sums(storage, split, number) for number in numbers}
    return [number for number, known in sums.items() if known is None or not same_bytes(storage, known)]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _json(content: Mapping[str, object]) -> bytes:
    return (json.dumps(content, indent=1) + "\n").encode()
