"""DocumentStore: documents in a folder, written atomically and guarded against lost updates."""

import hashlib
import os
import stat
import sys
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from threading import Lock
from typing import Any, Final

from filelock import FileLock, Timeout

from normalgan.errors import InputError, RunError, unwritable
from normalgan.files.limits import read_bounded
from normalgan.files.writing import write_bytes
from normalgan.studio.names import check_name, is_name
from normalgan.studio.server.bodies import MOST_BYTES
from normalgan.studio.server.refusals import ChangedError, MissingError

SUFFIX = ".normalgan"


class Anything:
    """Type of the tag that allows overwriting any version of a document."""


ANYTHING: Final = Anything()
Expected = str | None | Anything
"""The tag of the document that a change replaces; None if it must not exist yet; or `ANYTHING`."""
_LOCK = ".lock"
_PATIENCE = 20.0
"""Seconds to wait for another process, which locks the folder only while it saves."""


class DocumentStore:
    """A folder of documents that threads and processes share.

    Args:
        folder: folder of the documents; created if missing.

    Raises:
        InputError: if the folder is not writable.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._threads = Lock()
        self._processes = FileLock(folder / _LOCK)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Under the lock, half-written files can only be left over from a killed server.
            with self._held():
                for left in folder.glob(f".*{SUFFIX}.*.tmp"):
                    left.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(
                f"projects cannot be saved in {folder}: {error.strerror}; give another --projects.", error
            ) from error

    def entries(self) -> list[dict[str, Any]]:
        """Return the name, modification time (ISO, UTC) and size of each document, newest first.

        Only readable regular files are listed.
        """
        found = []
        for path in self.folder.glob(f"*{SUFFIX}"):
            if not is_name(path.stem):
                continue
            try:
                status = path.stat()
            except OSError:  # deleted in the meantime, or a link to itself
                continue
            if not stat.S_ISREG(status.st_mode):
                continue
            changed = datetime.fromtimestamp(status.st_mtime, UTC).isoformat()
            name = unicodedata.normalize("NFC", path.stem)
            found.append({"name": name, "changed": changed, "bytes": status.st_size})
        return sorted(found, key=lambda each: each["changed"], reverse=True)

    def read(self, name: str) -> tuple[bytes, str]:
        """Return a document and its tag.

        Raises:
            InputError: if the name is invalid, or the file is too large or cannot be read.
            MissingError: if the document does not exist.
        """
        path = self._path(name)
        try:
            content = read_bounded(path, MOST_BYTES)
        except FileNotFoundError:
            raise MissingError(f"there is nothing called {name!r}.") from None
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror}.") from None
        return content, _tag_of(content)

    def write(self, name: str, content: bytes, expected: Expected) -> str:
        """Write a document durably and return its tag.

        Raises:
            InputError: if the name is invalid.
            RunError: if the disk is full.
            ChangedError: if it has changed since it was read.
        """
        path = self._path(name)
        with self._held():
            self._check(name, expected)
            try:
                write_bytes(path, content)
                _sync(path.parent)
            except OSError as error:
                raise unwritable(f"{name!r} cannot be saved: {error.strerror}.", error) from error
        return _tag_of(content)

    def delete(self, name: str, expected: Expected) -> None:
        """Delete a document.

        Raises:
            InputError: if the name is invalid.
            MissingError: if the document does not exist.
            ChangedError: if it has changed since it was read.
        """
        path = self._path(name)
        with self._held():
            self.read(name)
            self._check(name, expected)
            path.unlink()

    def prune(self, most: int) -> None:
        """Delete all but the ``most`` newest documents."""
        with self._held():
            for old in self.entries()[most:]:
                self._path(old["name"]).unlink(missing_ok=True)

    @contextmanager
    def _held(self) -> Iterator[None]:
        """Lock the folder against other threads and processes.

        Raises:
            RunError: if another process does not release the lock.
            OSError: if the file system does not support locks.
        """
        try:
            with self._threads, self._processes.acquire(timeout=_PATIENCE):
                yield
        except Timeout:
            raise RunError(
                f"another program holds {self.folder}; end it, or give another --projects."
            ) from None

    def _path(self, name: str) -> Path:
        """Return the path of a document, even if macOS has decomposed the file name."""
        name = check_name(name)
        path = self.folder / f"{name}{SUFFIX}"
        if not name.isascii() and not path.exists():
            for other in self.folder.glob(f"*{SUFFIX}"):
                if unicodedata.normalize("NFC", other.stem) == name:
                    return other
        return path

    def _check(self, name: str, expected: Expected) -> None:
        if isinstance(expected, Anything):
            return
        try:
            there: str | None = self.read(name)[1]
        except MissingError:
            there = None
        if there == expected:
            return
        if expected is None:
            raise ChangedError(f"there is a project called {name!r} already.")
        has = "deleted" if there is None else "changed"
        raise ChangedError(f"{name!r} was {has} elsewhere in the meantime; save it under another name.")


def _tag_of(content: bytes) -> str:
    """Return the ETag of a document, which is a hash of its bytes."""
    return f'"{hashlib.sha256(content).hexdigest()[:32]}"'


def _sync(folder: Path) -> None:
    """Flush a folder's entries to disk, if the system supports it."""
    if sys.platform != "win32":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
