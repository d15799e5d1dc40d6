"""Layout: which sample of a split lies where, and in which bytes."""

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
}
"""The arrays of a split by name: type of number, and what follows (N, H, W) in the shape."""


@dataclass(frozen=True)
class Layout:
    """Which sample of a split lies where: all views of the first mesh, then of the second, and so on.

    Args:
        meshes: names of the meshes.
        views: samples a mesh.
        size: side of the pictures in pixels.
        per_shard: samples to a shard, the unit that is rendered, written and repaired.
    """

    meshes: tuple[str, ...]
    views: int
    size: int
    per_shard: int = 32

    def __len__(self) -> int:
        return len(self.meshes) * self.views

    @property
    def shards(self) -> int:
        """How many shards there are."""
        return -(-len(self) // self.per_shard)

    def indices(self, shard: int) -> range:
        """Return the samples of a shard."""
        return range(shard * self.per_shard, min((shard + 1) * self.per_shard, len(self)))


def encode(split: str, layout: Layout, shard: int, samples: list[Sample]) -> dict[str, bytes]:
    """Return a shard's objects by path; made in memory, so that what is written is known to the byte.

    Raises:
        ValueError: if the samples are not as many or not as large as the layout says.
    """
    indices = layout.indices(shard)
    memory, arrays = _arrays_in_memory(split, layout)
    for name, array in arrays.items():
        stack = np.stack([getattr(sample, name) for sample in samples])
        if stack.shape != (len(indices), *array.shape[1:]) or stack.dtype != array.dtype:
            raise ValueError(f"shard {shard}: {name} is {stack.dtype} {stack.shape}")
        array[indices.start : indices.stop] = stack
    paths = [f"{split}/{chunk_path(name, shard)}" for name in ARRAYS]
    return {path: memory[path].to_bytes() for path in paths}


def metadata(split: str, layout: Layout) -> dict[str, bytes]:
    """Return the JSON documents that describe the arrays, by path."""
    memory, _ = _arrays_in_memory(split, layout)
    return {path: buffer.to_bytes() for path, buffer in memory.items()}


def _arrays_in_memory(split: str, layout: Layout) -> tuple[dict[str, Any], dict[str, Any]]:
    memory: dict[str, Any] = {}
    group = zarr.create_group(MemoryStore(memory)).create_group(split)
    arrays = {}
    for name, (dtype, tail) in ARRAYS.items():
        inner = (layout.size, layout.size, *tail)
        arrays[name] = group.create_array(
            name,
            shape=(len(layout), *inner),
            chunks=(1, *inner),
            shards=(layout.per_shard, *inner),
            dtype=dtype,
            fill_value=0,
            compressors=[ZstdCodec(level=3), Crc32cCodec()],
            config={"write_empty_chunks": True},  # else an all-black sample leaves no chunk to check
        )
    return memory, arrays


def chunk_path(name: str, shard: int) -> str:
    """Return a shard's object as the Zarr 3 specification keys it: "default" chunk key encoding."""
    return "/".join([name, "c", str(shard), "0", "0", *("0" for _ in ARRAYS[name][1])])
