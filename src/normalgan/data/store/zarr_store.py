"""ObjectStore: a read-only Zarr store for an `ObjectFolder`."""

from collections.abc import Iterable
from typing import Any, NoReturn

from zarr.abc.store import ByteRequest, OffsetByteRequest, RangeByteRequest, Store, SuffixByteRequest
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.core.buffer.core import default_buffer_prototype

from normalgan.data.store.fsspec_storage import ObjectFolder

_METADATA = {"zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata"}  # Zarr checks which of them exist


class ObjectStore(Store):
    """A read-only Zarr store; an unreadable object raises `InputError`, a missing chunk `ValueError`.

    Zarr silently fills in zeros for a missing chunk. All chunks were written, so a missing one was lost,
    possibly during training.
    """

    supports_writes = False
    supports_deletes = False
    supports_listing = False

    def __init__(self, storage: ObjectFolder) -> None:
        super().__init__(read_only=True)
        self.storage = storage

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ObjectStore) and self.storage.url == other.storage.url

    def __hash__(self) -> int:
        return hash(self.storage.url)

    async def get(
        self, key: str, prototype: BufferPrototype | None = None, byte_range: ByteRequest | None = None
    ) -> Buffer | None:
        """Return an object or the requested part of it."""
        content = self.storage.read(key, *_limits(byte_range))
        if content is None and key.rpartition("/")[2] not in _METADATA:
            raise ValueError(f"{key} is missing")
        buffer = (prototype or default_buffer_prototype()).buffer
        return None if content is None else buffer.from_bytes(content)

    async def get_partial_values(
        self, prototype: BufferPrototype, key_ranges: Iterable[tuple[str, ByteRequest | None]]
    ) -> list[Buffer | None]:
        """Return parts of objects."""
        return [await self.get(key, prototype, byte_range) for key, byte_range in key_ranges]

    async def exists(self, key: str) -> bool:
        """Return whether an object exists."""
        return self.storage.size(key) is not None

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise NotImplementedError("an ObjectStore only reads objects by their keys.")

    # `ObjectFolder.write` writes whole shards, and reading samples does not need a list of the objects.
    set = delete = list = list_prefix = list_dir = _refuse


def _limits(byte_range: ByteRequest | None) -> tuple[int | None, int | None]:
    match byte_range:
        case RangeByteRequest(start, end):
            return start, end
        case OffsetByteRequest(offset):
            return offset, None
        case SuffixByteRequest(suffix):
            return -suffix, None
        case _:
            return None, None
