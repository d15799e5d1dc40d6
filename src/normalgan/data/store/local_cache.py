"""LocalCache: objects of a remote store on a local disk, within a size limit."""

import hashlib
import os
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock

from normalgan.errors import InputError, unwritable
from normalgan.files.writing import write_bytes
from normalgan.ranges import PositiveInt, check_ranges

__all__ = ["BUCKETS", "LocalCache"]

BUCKETS = 16
"""A cache is shared out by hash among so many folders, each with its own lock and share of the size."""

_PARTIAL = ".partial"
_LOCK = ".lock"
_FRESH = 60.0  # seconds in which a second use of an object is not noted: a note is a write to the disk


@dataclass(frozen=True)
class LocalCache:
    """Objects as files, for any number of processes of a machine at once.

    An object is written under its bucket's lock and gets its name when it is whole; before that, those of the
    bucket that were used longest ago make room. The kernel frees the lock of a killed process, and what it
    left half written is removed by the next one that takes the lock. So the bytes on disk never exceed the
    size, whoever is killed when. A reader takes no lock: an object that goes while it is read stays readable.

    Known packages were looked at first: fsspec's caches know no bound, Zarr's keeps its books in the memory
    of one process, and diskcache forgets files that a killed process was writing: they count for nothing.

    Args:
        folder: where; made if it is not there. Not on a network disk: the point is that it is near.
        size: bytes that may be used, shared by 16 buckets; the largest object must fit into one of them.

    Raises:
        InputError: if the size is not positive.
    """

    folder: str
    size: PositiveInt = 20 * 10**9

    def __post_init__(self) -> None:
        check_ranges(self)

    def read(
        self, key: str, fetch: Callable[[], bytes], start: int | None = None, stop: int | None = None
    ) -> bytes:
        """Return bytes of an object, after fetching the whole of it if it is not here.

        Args:
            key: name of the object, whose bytes never change.
            fetch: how to get it; what it raises is passed on.
            start: from which byte on; negative counts from the end, None is the first.
            stop: up to which byte, not included; None is the last.

        Raises:
            InputError: if the folder cannot be written to, or a bucket has no room for such an object.
        """
        path = self._path(key)
        with suppress(FileNotFoundError, NotADirectoryError), path.open("rb") as file:
            status = os.fstat(file.fileno())
            if time.time() - status.st_mtime > _FRESH:
                with suppress(
                    OSError
                ):  # evicted just now, or a disk that has become read-only: still readable
                    os.utime(path)
            first, last, _ = slice(start, stop).indices(status.st_size)
            file.seek(first)
            return file.read(last - first)
        content = fetch()
        self._keep(path, content)
        return content[start:stop]

    def forget(self, key: str) -> None:
        """Remove an object, if it is here: one that turned out to be damaged."""
        self._path(key).unlink(missing_ok=True)

    def _path(self, key: str) -> Path:
        digest = hashlib.sha256(key.encode()).hexdigest()
        return Path(self.folder) / f"{int(digest[:8], 16) % BUCKETS:02d}" / digest[8:40]

    def _keep(self, path: Path, content: bytes) -> None:
        share = self.size // BUCKETS
        if len(content) > share:
            raise InputError(
                f"the local cache's size is {self.size} bytes; for objects of {len(content)} bytes it must "
                f"be {len(content) * BUCKETS} or more."
            )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with FileLock(path.parent / _LOCK, poll_interval=0.01):
                _make_room(path.parent, share - len(content))
                write_bytes(path, content, path.parent / f"{uuid.uuid4().hex}{_PARTIAL}", durable=False)
        except OSError as error:
            raise unwritable(
                f"cannot write to the local cache {self.folder}: {error.strerror}; make room there or name "
                "another folder.",
                error,
            ) from error


def _make_room(bucket: Path, allowed: int) -> None:
    """Remove files, oldest use first, until no more than ``allowed`` bytes are left; needs the lock."""
    files = []
    for entry in os.scandir(bucket):
        if entry.name.endswith(_PARTIAL):  # whoever wrote it held the lock, so is no more
            Path(entry.path).unlink(missing_ok=True)
        elif entry.name != _LOCK:
            with suppress(FileNotFoundError):  # forgotten this moment
                status = entry.stat()
                files.append((status.st_mtime, status.st_size, entry.path))
    used = sum(size for _, size, _ in files)
    for _, size, path in sorted(files):
        if used <= allowed:
            break
        Path(path).unlink(missing_ok=True)
        used -= size
