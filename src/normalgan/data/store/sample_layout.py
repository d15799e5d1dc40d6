"""Layout: the order of the samples in a split, and their encoding in shards."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import zarr
from zarr.codecs import Crc32cCodec, ZstdCodec
from zarr.storage import MemoryStore

from normalgan.rendering.samples import Sample

ARRAYS: dict[str, tuple[str, tuple[int, ...]]] = {
    "sketch": ("uint8", ()),
    "normal": ("float16", (3,)),
    "mask": ("bool", ()),
    "hints": ("float16", (4,)),
}
"""The arrays of a split by name: dtype, and the part of the shape after (N, H, W)."""


def array_names(hints: bool) -> list[str]:
    """Return the names of the arrays of a split, with or without hints.

    >>> array_names(False)
    ['sketch', 'normal', 'mask']
    """
    return [name for name in ARRAYS if hints or name != "hints"]


@dataclass(frozen=True)
class Shard:
    """A few dozen samples that are rendered, written and repaired together.

    Args:
        split: split of the shard.
        number: index of the shard in the split.
        size: side of the pictures in pixels.
        room: capacity of a shard; the last shard may hold fewer samples.
        samples: mesh and view index of each sample.
        hints: whether the samples have hints.
    """

    split: str
    number: int
    size: int
    room: int
    samples: tuple[tuple[str, int], ...]
    hints: bool = False

    def __len__(self) -> int:
        return len(self.samples)

    @property
    def meshes(self) -> tuple[str, ...]:
        """The names of the meshes in the shard, in order."""
        return tuple(dict.fromkeys(mesh for mesh, _ in self.samples))

    @property
    def marker(self) -> str:
        """Path of the object that marks the shard as finished."""
        return f"done/{self.split}/{self.number}.json"


@dataclass(frozen=True)
class Layout:
    """The order of samples in a split: all views of the first mesh, then of the second, and so on.

    Args:
        meshes: names of the meshes.
        views: number of samples per mesh.
        size: side of the pictures in pixels.
        per_shard: number of samples per shard, the unit of rendering, writing and repair.
        hints: whether samples have hints.
    """

    meshes: tuple[str, ...]
    views: int
    size: int
    per_shard: int = 32
    hints: bool = False

    def __len__(self) -> int:
        return len(self.meshes) * self.views

    @property
    def shards(self) -> int:
        """Number of shards."""
        return -(-len(self) // self.per_shard)

    def indices(self, shard: int) -> range:
        """Return the indices of the samples in a shard."""
        return range(shard * self.per_shard, min((shard + 1) * self.per_shard, len(self)))

    def mesh_and_view(self, index: int) -> tuple[str, int]:
        """Return mesh name and view index of a sample."""
        return self.meshes[index // self.views], index % self.views

    def shard(self, split: str, number: int) -> Shard:
        """Return the description of a shard for rendering and writing."""
        samples = tuple(map(self.mesh_and_view, self.indices(number)))
        return Shard(split, number, self.size, self.per_shard, samples, self.hints)


def encode(shard: Shard, samples: Sequence[Sample]) -> dict[str, bytes]:
    """Return a shard's objects by path, encoded in memory so that their hashes are known before writing.

    Raises:
        ValueError: if number or size of the samples differ from those of the shard.
    """
    # An object depends only on its shard, so arrays with only this shard give the same bytes.
    memory, arrays = _arrays_in_memory(shard.split, len(shard), shard.size, shard.room, shard.hints)
    for name, array in arrays.items():
        stack = np.stack([getattr(sample, name) for sample in samples])
        if stack.shape != array.shape or stack.dtype != array.dtype:
            raise ValueError(f"shard {shard.number}: {name} is {stack.dtype} {stack.shape}")
        array[:] = stack
    return {
        chunk_path(shard.split, name, shard.number): memory[chunk_path(shard.split, name, 0)].to_bytes()
        for name in arrays
    }


def blank(size: int, hints: bool = False) -> Sample:
    """Return the placeholder of a sample that could not be rendered."""
    arrays = {name: ARRAYS[name] for name in array_names(hints)}
    return Sample(**{name: np.zeros((size, size, *tail), kind) for name, (kind, tail) in arrays.items()})


def metadata(split: str, layout: Layout) -> dict[str, bytes]:
    """Return the JSON documents that describe the arrays, by path."""
    memory, _ = _arrays_in_memory(split, len(layout), layout.size, layout.per_shard, layout.hints)
    return {path: buffer.to_bytes() for path, buffer in memory.items()}


def _arrays_in_memory(
    split: str, count: int, size: int, per_shard: int, hints: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    memory: dict[str, Any] = {}
    group = zarr.create_group(MemoryStore(memory)).create_group(split)
    arrays = {}
    for name in array_names(hints):
        dtype, tail = ARRAYS[name]
        inner = (size, size, *tail)
        arrays[name] = group.create_array(
            name,
            shape=(count, *inner),
            chunks=(1, *inner),
            shards=(per_shard, *inner),
            dtype=dtype,
            fill_value=0,
            compressors=[ZstdCodec(level=3), Crc32cCodec()],
            config={"write_empty_chunks": True},  # otherwise an all-black sample would have no chunk to check
        )
    return memory, arrays


def chunk_path(split: str, name: str, shard: int) -> str:
    """Return the path of a shard's object in Zarr 3's "default" chunk key encoding."""
    return "/".join([split, name, "c", str(shard), "0", "0", *("0" for _ in ARRAYS[name][1])])
