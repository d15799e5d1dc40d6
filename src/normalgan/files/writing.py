"""Atomic writing of files."""

import os
from contextlib import suppress
from pathlib import Path

__all__ = ["write_bytes"]


def write_bytes(
    path: str | Path, content: bytes | memoryview, partial: Path | None = None, durable: bool = True
) -> None:
    """Write a file atomically, and make its folder if missing.

    Args:
        path: path of the file.
        content: all of it.
        partial: where it is written before it is renamed, on the same disk; None is beside it.
        durable: whether to wait until it is on the disk, so that it outlives a power cut.

    Raises:
        OSError: if it cannot be written; it names the file.
    """
    path = Path(path)
    temporary = partial or path.with_name(f".{path.name}.{os.getpid()}.tmp")
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary.parent.mkdir(parents=True, exist_ok=True)
    try:
        if durable:
            with temporary.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())  # else the name may outlive a power cut, and the content not
        else:
            temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:  # a full disk does not say which file
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):  # of a read-only disk, which would be told in place of the first error
            temporary.unlink(missing_ok=True)
