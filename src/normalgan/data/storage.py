"""Storage: a folder for samples on this disk or behind any URL that fsspec knows."""

import contextlib
import time
import uuid
from pathlib import Path

from fsspec.core import url_to_fs  # type: ignore[import-untyped]
from fsspec.implementations.local import LocalFileSystem  # type: ignore[import-untyped]
from fsspec.spec import AbstractFileSystem  # type: ignore[import-untyped]
from zarr.abc.store import Store
from zarr.storage import FsspecStore, LocalStore

from normalgan.errors import InputError, brief, unwritable

_PARTIAL = ".partial"
_ABANDONED = 3600.0  # seconds; no object takes an hour to write


class Storage:
    """Small objects under one folder, each written whole or not at all.

    Cheap to make, and to hand to another process: nothing stays open.

    Args:
        url: a path, or a URL such as ``file:///data``, ``memory://x`` or ``s3://bucket/x``.

    Raises:
        InputError: if no file system for such a URL is known or installed.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self._files()

    def __truediv__(self, name: str) -> "Storage":
        return Storage(self.url + ("" if self.url.endswith("/") else "/") + name)

    @property
    def in_memory(self) -> bool:
        """Whether other processes cannot see what this one writes."""
        return self.url.startswith("memory:")

    def read(self, path: str) -> bytes | None:
        """Return an object's bytes, or None if it is not there.

        Raises:
            InputError: if it is there but cannot be read.
        """
        files, root = self._files()
        try:
            return bytes(files.cat_file(f"{root}/{path}"))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            raise InputError(f"cannot read {self.url}/{path}: {error.strerror or brief(error)}.") from error

    def size(self, path: str) -> int | None:
        """Return an object's length in bytes, or None if it is not there. Raises as `read` does."""
        files, root = self._files()
        try:
            return int(files.info(f"{root}/{path}")["size"])
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            raise InputError(f"cannot read {self.url}/{path}: {error.strerror or brief(error)}.") from error

    def write(self, path: str, content: bytes) -> None:
        """Write an object: a reader sees the old bytes or the new ones, never a part.

        Raises:
            InputError: if the disk is full or may not be written to.
        """
        files, root = self._files()
        try:
            if isinstance(files, LocalFileSystem):
                _write_atomically(Path(root), path, content)
            else:  # object stores show an object once it is complete
                files.pipe_file(f"{root}/{path}", content)
        except OSError as error:
            reason = error.strerror or brief(error)
            raise unwritable(
                f"cannot write the samples to {self.url}: {reason}; make room there or name another folder.",
                error,
            ) from error

    def delete(self, path: str) -> None:
        """Remove an object, if it is there.

        Raises:
            InputError: if it may not be removed.
        """
        files, root = self._files()
        try:
            files.rm_file(f"{root}/{path}")
        except FileNotFoundError:
            pass
        except OSError as error:
            raise InputError(f"cannot remove {self.url}/{path}: {error.strerror or brief(error)}.") from error

    def sweep(self) -> None:
        """Remove what killed processes have left half written, if that can be done."""
        files, root = self._files()
        if not isinstance(files, LocalFileSystem):
            return
        with contextlib.suppress(OSError):  # a finished data set may lie on a read-only disk
            for path in (Path(root) / _PARTIAL).iterdir():
                if time.time() - path.stat().st_mtime > _ABANDONED:
                    path.unlink(missing_ok=True)

    def zarr_store(self) -> Store:
        """Return the folder as Zarr reads it; belongs to the process that asks."""
        files, root = self._files()
        if isinstance(files, LocalFileSystem):
            return LocalStore(root, read_only=True)
        return FsspecStore.from_url(self.url, read_only=True)

    def _files(self) -> tuple[AbstractFileSystem, str]:
        # Asked for anew each time: fsspec keeps one a process, so that none is carried across a fork.
        try:
            files, root = url_to_fs(self.url)
        except (ValueError, ImportError) as error:
            raise InputError(f"no samples can be kept at {self.url}: {brief(error)}.") from error
        return files, root


def _write_atomically(root: Path, path: str, content: bytes) -> None:
    target, partial = root / path, root / _PARTIAL / uuid.uuid4().hex
    target.parent.mkdir(parents=True, exist_ok=True)
    partial.parent.mkdir(exist_ok=True)
    try:
        partial.write_bytes(content)
        partial.replace(target)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
