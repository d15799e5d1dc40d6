"""Storage: a folder for samples on this disk or behind any URL that fsspec knows."""

import contextlib
from pathlib import Path

from fsspec.implementations.local import LocalFileSystem  # type: ignore[import-untyped]
from fsspec.spec import AbstractFileSystem  # type: ignore[import-untyped]

from normalgan.data.store.partials import abandoned, partial_name
from normalgan.data.store.remote import connect, no_bucket, reason
from normalgan.errors import InputError, brief, unwritable
from normalgan.files.writing import write_bytes

__all__ = ["Storage"]

_PARTIAL = ".partial"


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

    @property
    def local(self) -> bool:
        """Whether it is a folder on a disk of this machine."""
        return isinstance(self._files()[0], LocalFileSystem)

    @property
    def address(self) -> str:
        """What another process calls it, wherever that one is: a path from the root on, or the URL."""
        return self.root if self.local else self.url

    @property
    def root(self) -> str:
        """The folder as its file system calls it; for a local one, its path."""
        return self._files()[1]

    def read(self, path: str, start: int | None = None, stop: int | None = None) -> bytes | None:
        """Return an object's bytes, or None if it is not there.

        Args:
            path: where it is in the folder.
            start: from which byte on; negative counts from the end, None is the first.
            stop: up to which byte, not included; None is the last.

        Raises:
            InputError: if it is there but cannot be read, or the bucket or its server is not.
        """
        files, root = self._files()
        try:
            return bytes(files.cat_file(f"{root}/{path}", start=start, end=stop))
        except (FileNotFoundError, NotADirectoryError) as error:
            if no_bucket(error):
                raise InputError(f"there is no such bucket as in {self.url}; create it first.") from error
            return None
        except Exception as error:  # what a remote store raises need not be an OSError: botocore's is not
            raise InputError(f"cannot read {self.url}/{path}: {reason(error)}.") from error

    def size(self, path: str) -> int | None:
        """Return an object's length in bytes, or None if it is not there. Raises as `read` does."""
        files, root = self._files()
        try:
            return int(files.info(f"{root}/{path}")["size"])
        except (FileNotFoundError, NotADirectoryError):
            return None
        except Exception as error:  # as in `read`
            raise InputError(f"cannot read {self.url}/{path}: {reason(error)}.") from error

    def names(self, folder: str) -> set[str]:
        """Return the paths of all objects below a folder, relative to it; one request for a thousand.

        Raises:
            InputError: if they cannot be listed.
        """
        files, root = self._files()
        top = f"{root}/{folder}"
        try:
            found = files.find(top)
        except (FileNotFoundError, NotADirectoryError):
            return set()
        except Exception as error:  # as in `read`
            raise InputError(f"cannot read {self.url}/{folder}: {reason(error)}.") from error
        return {path[len(top) + 1 :] for path in found}

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
        except Exception as error:  # as in `read`
            raise unwritable(
                f"cannot write the samples to {self.url}: {reason(error)}; "
                "make room there or name another folder.",
                error if isinstance(error, OSError) else OSError(),
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
        except Exception as error:  # as in `read`
            raise InputError(f"cannot remove {self.url}/{path}: {reason(error)}.") from error

    def sweep(self) -> None:
        """Remove what killed processes have left half written, if that can be done."""
        files, root = self._files()
        if not isinstance(files, LocalFileSystem):
            return
        with contextlib.suppress(OSError):  # a finished data set may lie on a read-only disk
            for path in (Path(root) / _PARTIAL).iterdir():
                if abandoned(path):
                    path.unlink(missing_ok=True)

    def _files(self) -> tuple[AbstractFileSystem, str]:
        # Asked for anew each time: fsspec keeps one a process, so that none is carried across a fork.
        try:
            files, root = connect(self.url)
        except (ValueError, ImportError) as error:
            raise InputError(f"no samples can be kept at {self.url}: {brief(error)}.") from error
        return files, root


def _write_atomically(root: Path, path: str, content: bytes) -> None:
    # Not durable: what a power cut spoils its checksum finds.
    write_bytes(root / path, content, root / _PARTIAL / partial_name(), durable=False)
