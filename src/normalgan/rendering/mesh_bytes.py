"""Contents of mesh files, limited in size and read once for both fingerprint and mesh."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded

_kept: ContextVar[dict[Path, bytes] | None] = ContextVar("bytes of mesh files", default=None)


@contextmanager
def read_once() -> Iterator[None]:
    """Keep the bytes of each mesh file after the first read within the context.

    A file may be replaced at any time, but within the context, fingerprint and mesh come from the same
    bytes.
    """
    token = _kept.set({})
    try:
        yield
    finally:
        _kept.reset(token)


def mesh_bytes(path: Path) -> bytes:
    """Return the bytes of a mesh file, or of a file that it refers to.

    Raises:
        InputError: if the file cannot be read, is larger than `MOST_BYTES`, or is a pipe or a device.
    """
    kept = _kept.get()
    if kept is not None and path in kept:
        return kept[path]
    try:
        data = read_bounded(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    if kept is not None:
        kept[path] = data
    return data
