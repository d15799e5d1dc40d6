"""Atomic writing of files."""

import os
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile


def write_bytes(
    path: str | Path, content: bytes | memoryview, partial: Path | None = None, durable: bool = True
) -> None:
    """Write a file atomically, and create its folder if it is missing.

    Args:
        path: path of the file.
        content: content of the file.
        partial: temporary path on the same disk; None for a path next to the file.
        durable: whether to wait until the file is on disk, so that it survives a power failure.

    Raises:
        OSError: if the file cannot be written; the error has its name.
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
                os.fsync(file.fileno())  # or the name might survive a power cut without the content
        else:
            temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:  # the error of a full disk does not name the file
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):  # on a read-only disk, this would mask the first error
            temporary.unlink(missing_ok=True)


def probe(folder: Path) -> None:
    """Raise `OSError` if no file can be written to a folder.

    A file is written, because permissions do not show that a disk is full or read-only.
    """
    with TemporaryFile(dir=folder) as file:
        file.write(b"0")
