"""DocumentStore: documents in a folder, each old or new but never half; nobody overwrites unseen work."""

import hashlib
import os
import sys
from datetime import UTC, datetime
from pathlib import Path
from threading import Lock
from typing import Any, Final

from normalgan.errors import unwritable
from normalgan.normals import write_bytes
from normalgan.studio.names import check_name, is_name
from normalgan.studio.refusals import ChangedError, MissingError

SUFFIX = ".normalgan"


class Anything:
    """What is expected of a document that may be overwritten, whatever it holds."""


ANYTHING: Final = Anything()
Expected = str | None | Anything
"""The tag of the document that is to be changed, None for that there is none yet, or `ANYTHING`."""


class DocumentStore:
    """A folder of documents. It is for one process; in it, for all threads.

    Args:
        folder: where they lie; it is made where missing.

    Raises:
        InputError: if nothing can be written there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = Lock()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for left in folder.glob(f".*{SUFFIX}.*.tmp"):  # by a server that was killed
                left.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(
                f"projects cannot be kept in {folder}: {error.strerror}; give another --projects.",
                error,
            ) from error

    def entries(self) -> list[dict[str, Any]]:
        """Return the name, the time of the last change (ISO, UTC) and the size of each, newest first."""
        found = []
        for path in self.folder.glob(f"*{SUFFIX}"):
            if not is_name(path.stem):
                continue
            try:
                status = path.stat()
            except FileNotFoundError:  # deleted just now
                continue
            changed = datetime.fromtimestamp(status.st_mtime, UTC).isoformat()
            found.append({"name": path.stem, "changed": changed, "bytes": status.st_size})
        return sorted(found, key=lambda each: each["changed"], reverse=True)

    def read(self, name: str) -> tuple[bytes, str]:
        """Return a document and its tag.

        Raises:
            InputError: if the name is none.
            MissingError: if there is none of that name.
        """
        try:
            content = self._path(name).read_bytes()
        except FileNotFoundError:
            raise MissingError(f"there is nothing called {name!r}.") from None
        return content, tag_of(content)

    def write(self, name: str, content: bytes, expected: Expected) -> str:
        """Write a document, on the disk when this returns, and return its tag.

        Raises:
            InputError: if the name is none.
            RunError: if the disk is full.
            ChangedError: if what is there is not what was expected.
        """
        path = self._path(name)
        with self._lock:
            self._check(name, expected)
            try:
                write_bytes(path, content)
                _sync(path.parent)
            except OSError as error:
                raise unwritable(f"{name!r} cannot be saved: {error.strerror}.", error) from error
        return tag_of(content)

    def delete(self, name: str, expected: Expected) -> None:
        """Delete a document.

        Raises:
            InputError: if the name is none.
            MissingError: if there is none of that name.
            ChangedError: if what is there is not what was expected.
        """
        path = self._path(name)
        with self._lock:
            self.read(name)
            self._check(name, expected)
            path.unlink()

    def prune(self, most: int) -> None:
        """Delete all but the ``most`` newest documents."""
        with self._lock:
            for old in self.entries()[most:]:
                self._path(old["name"]).unlink(missing_ok=True)

    def _path(self, name: str) -> Path:
        return self.folder / f"{check_name(name)}{SUFFIX}"

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


def tag_of(content: bytes) -> str:
    """Return the tag of a document: the same for the same bytes, and as HTTP's ETag is written."""
    return f'"{hashlib.sha256(content).hexdigest()[:32]}"'


def _sync(folder: Path) -> None:
    """Have a folder's names on the disk, where that can be asked for."""
    if sys.platform != "win32":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
