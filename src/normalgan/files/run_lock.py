"""A lock, so that only one run at a time trains in a folder."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from normalgan.errors import InputError, brief

__all__ = ["NAME", "check_writable", "one_run_in"]

NAME = ".running"


@contextmanager
def one_run_in(folder: Path) -> Iterator[None]:
    """Lock a run's folder, so that no other run writes checkpoints into it.

    The system releases the lock when the process ends, however it ends; a lock file left behind blocks
    nothing.

    Args:
        folder: folder of the run; created if it is missing, and removed again if it stays empty.

    Raises:
        InputError: if another process holds it, on this machine or another with the same file system; or if
            files cannot be locked there.
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
    except (OSError, NotImplementedError) as error:  # some network file systems have no locks
        reason = error.strerror if isinstance(error, OSError) and error.strerror else brief(error)
        raise InputError(
            f"{folder} cannot be locked for this run ({reason}); give a --trainer.default_root_dir on "
            "another file system."
        ) from error
    try:
        yield
    finally:
        with suppress(OSError):  # Windows removes no file that is open
            (folder / NAME).unlink()  # while it is held: nobody can take it between
        lock.release()
        with suppress(OSError):  # what holds something stays, and all above it
            for path in made:
                path.rmdir()


def check_writable(folder: Path) -> None:
    """Check that a folder can be made and written to, without making it.

    Raises:
        InputError: if it cannot.
    """
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise InputError(f"the run cannot be stored in {folder}: {there} is not a folder.")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"the run cannot be stored in {folder}: {there} is not writable.")
