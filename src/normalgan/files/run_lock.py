"""A lock that lets only one run at a time train in a folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from normalgan.errors import InputError, brief

NAME = ".running"


@contextmanager
def one_run_in(folder: Path) -> Iterator[None]:
    """Lock a run's folder, so that no other run writes checkpoints into it.

    The system releases the lock whenever and however the process ends, so a leftover lock file blocks
    nothing.

    Args:
        folder: folder of the run; created if it is missing, and removed again if it stays empty.

    Raises:
        InputError: if another process holds the lock, on this machine or another with the same file
            system, or if the file system does not support locks.
    """
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / NAME, blocking=False)
    try:
        lock.acquire()
    except Timeout:
        raise InputError(
            f"another run trains in {folder} now; give another --trainer.default_root_dir."
        ) from None
    except (OSError, NotImplementedError) as error:  # some network file systems do not support locks
        reason = error.strerror if isinstance(error, OSError) and error.strerror else brief(error)
        raise InputError(
            f"{folder} cannot be locked for this run ({reason}); give a --trainer.default_root_dir on "
            "another file system."
        ) from error
    try:
        yield
    finally:
        with suppress(OSError):  # Windows cannot remove an open file
            (folder / NAME).unlink()  # removed while held, so no other process can take it in between
        lock.release()
        with suppress(OSError):  # stop at the first folder that is not empty
            for path in made:
                path.rmdir()


def check_writable(folder: Path) -> None:
    """Check that a folder can be created and written to, without creating it.

    Raises:
        InputError: if it cannot be created or written to.
    """
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise InputError(f"the run cannot be stored in {folder}: {there} is not a folder.")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"the run cannot be stored in {folder}: {there} is not writable.")
