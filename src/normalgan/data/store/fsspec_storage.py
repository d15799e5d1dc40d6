"""Storage: a folder for samples on this disk or behind any URL that fsspec knows."""

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

__all__ = ["Storage", "options", "reason"]

_PARTIAL = ".partial"
_LONG = 3600.0
"""Seconds; nothing takes an hour to write."""
_ATTEMPTS = 3
"""Attempts of botocore at a request, the first included."""
_ROUNDS = 2
"""Rounds of such attempts where no answer came, and again of these where an answer broke off."""
_SECONDS = 10
"""Seconds without a byte after which a request is given up."""


class Storage:
    """Small objects under one folder, each written atomically.

    Cheap to create and to send to another process: it keeps nothing open.

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
        """Its address for processes elsewhere: an absolute path, or the URL."""
        return self.root if self.local else self.url

    @property
    def root(self) -> str:
        """The folder's path in its file system."""
        return self._files()[1]

    def read(self, path: str, start: int | None = None, stop: int | None = None) -> bytes | None:
        """Return an object's bytes, or None if it is not there.

        Args:
            path: where it is in the folder.
            start: first byte; negative counts from the end, None is the first.
            stop: byte after the last one; None reads to the end.

        Raises:
            InputError: if it is there but cannot be read, or the bucket or its server is not.
        """
        files, root = self._files()
        try:
            return bytes(files.cat_file(f"{root}/{path}", start=start, end=stop))
        except (FileNotFoundError, NotADirectoryError) as error:
            if "bucket does not exist" in str(error):  # S3 reports it as it does a missing object
                raise InputError(f"the bucket of {self.url} does not exist; create it first.") from error
            return None
        except Exception as error:  # a remote store's error need not be an OSError; botocore's is not
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
            InputError: if the disk is full or is not writable.
        """
        files, root = self._files()
        try:
            if isinstance(files, LocalFileSystem):
                # Not synced to disk: the checksum finds what a power cut damages.
                partial = Path(root, _PARTIAL, uuid.uuid4().hex)
                write_bytes(Path(root, path), content, partial, durable=False)
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
        """Remove partial files of killed processes, at least an hour old, if possible."""
        files, root = self._files()
        if not isinstance(files, LocalFileSystem):
            return
        with contextlib.suppress(OSError):  # a finished data set may lie on a read-only disk
            for path in (Path(root) / _PARTIAL).iterdir():
                if time.time() - path.stat().st_mtime > _LONG:
                    path.unlink(missing_ok=True)

    def _files(self) -> tuple[AbstractFileSystem, str]:
        # Asked for each time, because fsspec keeps one for each process, and none may cross a fork.
        try:
            files, root = url_to_fs(self.url, **options(self.url))
        except (ValueError, ImportError) as error:
            raise InputError(f"no samples can be kept at {self.url}: {brief(error)}.") from error
        if "s3" in files.protocol:
            # s3fs retries five times on top of botocore's retries, and five times again when reading an
            # object: an endpoint that accepts requests but never answers would block for many minutes.
            files.retries = _ROUNDS
        return files, root


def options(url: str) -> dict[str, Any]:
    """Return the options of the file system behind a URL.

    Listings are not kept: other processes write there too. S3 gives up on an endpoint after seconds, not
    after minutes, as botocore does by default; for other limits, set ``config_kwargs`` in fsspec's
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
    """Return the reason why a file system failed, in a few words.

    >>> reason(OSError(28, "No space left on device"))
    'No space left on device'
    >>> reason(PermissionError("The access key is unknown."))
    'The access key is unknown (are the credentials right?)'
    """
    text = ((error.strerror if isinstance(error, OSError) else None) or brief(error)).rstrip(".")
    distant = isinstance(error, PermissionError) and not isinstance(error.errno, int)
    return f"{text} (are the credentials right?)" if distant else text
