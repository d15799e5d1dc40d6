"""Layout: the order of the samples in a split, and their encoding in shards."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import zarr
from zarr.codecs import Crc32cCodec, ZstdCodec
from zarr.storage import MemoryStore

from normalgan.rendering.samples import Sample

__all__ = ["ARRAYS", "Layout", "Shard", "array_names", "blank", "chunk_path", "encode", "metadata"]

ARRAYS: dict[str, tuple[str, tuple[int, ...]]] = {
    "sketch": ("uint8", ()),
    "normal": ("float16", (3,)),
    "mask": ("bool", ()),
    "hints": ("float16", (4,)),
}
"""The arrays of a split by name: type of number, and what follows (N, H, W) in the shape."""


def array_names(hints: bool) -> list[str]:
    """Return the names of a split's arrays, with or without hints.

    >>> array_names(False)
    ['sketch', 'normal', 'mask']
    """
    return [name for name in ARRAYS if hints or name != "hints"]


@dataclass(frozen=True)
class Shard:
    """A few dozen samples that are rendered, written and repaired together.

    Args:
        split: which part of the data set it is in.
        number: which shard of the split.
        size: side of the pictures in pixels.
        room: samples that a shard has room for; the last one holds fewer.
        samples: mesh and number of the view of each sample.
        hints: whether its samples have hints.
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
        """The names of its meshes, in order."""
        return tuple(dict.fromkeys(mesh for mesh, _ in self.samples))

    @property
    def marker(self) -> str:
        """The object that marks it as finished."""
        return f"done/{self.split}/{self.number}.json"


@dataclass(frozen=True)
class Layout:
    """The order of samples in a split: all views of the first mesh, then of the second, and so on.

    Args:
        meshes: names of the meshes.
        views: samples a mesh.
        size: side of the pictures in pixels.
        per_shard: samples to a shard, the unit that is rendered, written and repaired.
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
        """How many shards there are."""
        return -(-len(self) // self.per_shard)

    def indices(self, shard: int) -> range:
        """Return the samples of a shard."""
        return range(shard * self.per_shard, min((shard + 1) * self.per_shard, len(self)))

    def mesh_and_view(self, index: int) -> tuple[str, int]:
        """Return the name of a sample's mesh and the number of the view of it."""
        return self.meshes[index // self.views], index % self.views

    def shard(self, split: str, number: int) -> Shard:
        """Return everything needed to render and write a shard."""
        samples = tuple(map(self.mesh_and_view, self.indices(number)))
        return Shard(split, number, self.size, self.per_shard, samples, self.hints)


def encode(shard: Shard, samples: Sequence[Sample]) -> dict[str, bytes]:
    """Return a shard's objects by path, made in memory so that their hashes are known before writing.

    Raises:
        ValueError: if the samples are not as many or not as large as the shard says.
    """
    # An object depends on nothing outside its shard, so arrays of this shard alone give the same bytes.
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
            config={"write_empty_chunks": True},  # else an all-black sample leaves no chunk to check
        )
    return memory, arrays


def chunk_path(split: str, name: str, shard: int) -> str:
    """Return a shard's object as the Zarr 3 specification keys it: "default" chunk key encoding."""
    return "/".join([split, name, "c", str(shard), "0", "0", *("0" for _ in ARRAYS[name][1])])
