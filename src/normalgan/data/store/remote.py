"""What is said to a file system behind a URL so that it answers soon and truly, and what it answers."""

import os
from typing import Any

import fsspec  # type: ignore[import-untyped]
from fsspec.core import url_to_fs  # type: ignore[import-untyped]
from fsspec.spec import AbstractFileSystem  # type: ignore[import-untyped]

from normalgan.errors import brief

__all__ = ["connect", "no_bucket", "options", "reason"]

_ATTEMPTS = 3
"""Attempts of botocore at a request, the first included."""
_ROUNDS = 2
"""Rounds of such attempts where no answer came, and again of these where an answer broke off."""
_SECONDS = 10
"""Seconds without a byte after which a request is given up."""


def options(url: str) -> dict[str, Any]:
    """Return what the file system behind a URL is opened with.

    Listings are not kept: other processes write there too. S3 gives up on an endpoint after seconds, not
    after minutes, as botocore does by default; whoever needs other limits sets ``config_kwargs`` in fsspec's
    configuration (FSSPEC_S3_CONFIG_KWARGS, say) or AWS_MAX_ATTEMPTS and AWS_RETRY_MODE.

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


def connect(url: str) -> tuple[AbstractFileSystem, str]:
    """Return the file system behind a URL, and what it calls the place there.

    s3fs repeats what botocore has repeated already, five times, and to read an object that five times: an
    endpoint that accepts requests and answers none would hold a command for many minutes.

    Raises:
        ValueError, ImportError: if none is known or installed.
    """
    files, root = url_to_fs(url, **options(url))
    if "s3" in files.protocol:
        files.retries = _ROUNDS
    return files, root


def reason(error: BaseException) -> str:
    """Return in a few words why a file system refused.

    >>> reason(OSError(28, "No space left on device"))
    'No space left on device'
    >>> reason(PermissionError("The access key is unknown."))
    'The access key is unknown (are the credentials right?)'
    """
    text = ((error.strerror if isinstance(error, OSError) else None) or brief(error)).rstrip(".")
    distant = isinstance(error, PermissionError) and not isinstance(error.errno, int)
    return f"{text} (are the credentials right?)" if distant else text


def no_bucket(error: BaseException) -> bool:
    """Whether not the object but the bucket it should be in is missing: S3 says both by one kind of error.

    >>> no_bucket(FileNotFoundError("The specified bucket does not exist"))
    True
    """
    return "bucket does not exist" in str(error)
