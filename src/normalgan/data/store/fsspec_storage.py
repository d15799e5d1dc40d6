"""ObjectFolder: a folder for samples on a local disk or at any URL that fsspec supports."""

import contextlib
import os
import time
import uuid
from pathlib import Path
from typing import Any

import fsspec  # type: ignore[import-untyped]
from fsspec.core import url_to_fs  # type: ignore[import-untyped]
from fsspec.implementations.local import LocalFileSystem  # type: ignore[import-untyped]
from fsspec.spec import AbstractFileSystem  # type: ignore[import-untyped]

from normalgan.errors import InputError, brief, unwritable
from normalgan.files.writing import write_bytes

_PARTIAL = ".partial"
_LONG = 3600.0
"""Age in seconds after which a partial file is stale; no write takes an hour."""
_ATTEMPTS = 3
"""Number of botocore's attempts for a request, including the first."""
_ROUNDS = 2
"""Number of rounds of such attempts without an answer, and of repetitions after an interrupted answer."""
_SECONDS = 10
"""Timeout of a request in seconds without a byte."""


class ObjectFolder:
    """A folder of small objects, each written atomically.

    It keeps nothing open, so it is cheap to create and to send to another process.

    Args:
        url: path, or URL such as ``file:///data``, ``memory://x`` or ``s3://bucket/x``.

    Raises:
        InputError: if there is no file system for the URL, or its package is not installed.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self._files()

    def __truediv__(self, name: str) -> "ObjectFolder":
        return ObjectFolder(self.url + ("" if self.url.endswith("/") else "/") + name)

    @property
    def in_memory(self) -> bool:
        """Whether the folder is in memory, so other processes cannot see it."""
        return self.url.startswith("memory:")

    @property
    def local(self) -> bool:
        """Whether the folder is on a disk of this machine."""
        return isinstance(self._files()[0], LocalFileSystem)

    @property
    def address(self) -> str:
        """Address for other processes: an absolute path or the URL."""
        return self.root if self.local else self.url

    @property
    def root(self) -> str:
        """Path of the folder in its file system."""
        return self._files()[1]

    def read(self, path: str, start: int | None = None, stop: int | None = None) -> bytes | None:
        """Return the bytes of an object, or None if it does not exist.

        Args:
            path: path within the folder.
            start: offset of the first byte, negative from the end; None for 0.
            stop: offset after the last byte; None reads to the end.

        Raises:
            InputError: if the object exists but cannot be read, or bucket or server are missing.
        """
        files, root = self._files()
        try:
            return bytes(files.cat_file(f"{root}/{path}", start=start, end=stop))
        except (FileNotFoundError, NotADirectoryError) as error:
            if "bucket does not exist" in str(error):  # S3 reports a missing bucket like a missing object
                raise InputError(f"the bucket of {self.url} does not exist; create it first.") from error
            return None
        except Exception as error:  # errors of remote stores, such as botocore's, need not be OSErrors
            raise InputError(f"cannot read {self.url}/{path}: {reason(error)}.") from error

    def size(self, path: str) -> int | None:
        """Return the length of an object in bytes, or None if it does not exist. Raises as `read`."""
        files, root = self._files()
        try:
            return int(files.info(f"{root}/{path}")["size"])
        except (FileNotFoundError, NotADirectoryError):
            return None
        except Exception as error:  # as in `read`
            raise InputError(f"cannot read {self.url}/{path}: {reason(error)}.") from error

    def names(self, folder: str) -> set[str]:
        """Return the relative paths of all objects below a folder, with one request per thousand objects.

        Raises:
            InputError: if the folder cannot be listed.
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
        """Write an object atomically: readers see either the old or the new bytes.

        Raises:
            InputError: if the disk is full or not writable.
        """
        files, root = self._files()
        try:
            if isinstance(files, LocalFileSystem):
                # Not synced to disk, because checksums detect damage by a power cut.
                partial = Path(root, _PARTIAL, uuid.uuid4().hex)
                write_bytes(Path(root, path), content, partial, durable=False)
            else:  # object stores expose only complete objects
                files.pipe_file(f"{root}/{path}", content)
        except Exception as error:  # as in `read`
            raise unwritable(
                f"cannot write the samples to {self.url}: {reason(error)}; "
                "free some space there or name another folder.",
                error if isinstance(error, OSError) else OSError(),
            ) from error

    def delete(self, path: str) -> None:
        """Remove an object if it exists.

        Raises:
            InputError: if it cannot be removed.
        """
        files, root = self._files()
        try:
            files.rm_file(f"{root}/{path}")
        except FileNotFoundError:
            pass
        except Exception as error:  # as in `read`
            raise InputError(f"cannot remove {self.url}/{path}: {reason(error)}.") from error

    def sweep(self) -> None:
        """Try to remove partial files that killed processes left at least an hour ago."""
        files, root = self._files()
        if not isinstance(files, LocalFileSystem):
            return
        with contextlib.suppress(OSError):  # a finished data set may be on a read-only disk
            for path in (Path(root) / _PARTIAL).iterdir():
                if time.time() - path.stat().st_mtime > _LONG:
                    path.unlink(missing_ok=True)

    def _files(self) -> tuple[AbstractFileSystem, str]:
        # Not stored, because fsspec caches file systems per process and they must not be used after a
        # fork.
        try:
            files, root = url_to_fs(self.url, **options(self.url))
        except (ValueError, ImportError) as error:
            raise InputError(f"no samples can be kept at {self.url}: {brief(error)}.") from error
        if "s3" in files.protocol:
            # s3fs retries five times on top of botocore's retries, and another five times when reading an
            # object, so an endpoint that accepts requests but never answers would block for many minutes.
            files.retries = _ROUNDS
        return files, root


def options(url: str) -> dict[str, Any]:
    """Return the options for the file system of a URL.

    Listings are not cached, because other processes write there too. S3 requests time out after seconds,
    not after minutes as by default in botocore. For other limits, set ``config_kwargs`` in fsspec's
    configuration (such as FSSPEC_S3_CONFIG_KWARGS), or AWS_MAX_ATTEMPTS and AWS_RETRY_MODE.

    >>> options("/data"), options("file:///data")
    ({}, {})
    """
    protocol = fsspec.core.split_protocol(url)[0] or "file"
    if protocol in {"file", "local"}:
        return {}
    found: dict[str, Any] = {"use_listings_cache": False}
    configured = {key for name in ("s3", "s3a") for key in fsspec.config.conf.get(name, {})}
    if protocol in {"s3", "s3a"} and "config_kwargs" not in configured:
        # https://botocore.amazonaws.com/v1/documentation/api/latest/reference/config.html
        limits: dict[str, Any] = {"connect_timeout": 5, "read_timeout": _SECONDS}
        if not {"AWS_MAX_ATTEMPTS", "AWS_RETRY_MODE"} & set(os.environ):
            limits["retries"] = {"total_max_attempts": _ATTEMPTS, "mode": "standard"}
        found["config_kwargs"] = limits
    return found


def reason(error: BaseException) -> str:
    """Return a short reason why a file system failed.

    >>> reason(OSError(28, "No space left on device"))
    'No space left on device'
    >>> reason(PermissionError("The access key is unknown."))
    'The access key is unknown (are the credentials right?)'
    """
    text = ((error.strerror if isinstance(error, OSError) else None) or brief(error)).rstrip(".")
    distant = isinstance(error, PermissionError) and not isinstance(error.errno, int)
    return f"{text} (are the credentials right?)" if distant else text
