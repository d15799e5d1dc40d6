"""Lock of a run: one run at a time trains in a folder."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from normalgan.errors import InputError

NAME = ".running"


@contextmanager
def one_run_in(folder: Path) -> Iterator[None]:
    """Hold a run's folder, so that no other run can write its checkpoints among those of this one.

    The system lets go of it when the process ends, however it ends; a file left behind stops nobody.

    Args:
        folder: of the run; made if it is not there.

    Raises:
        InputError: if another process holds it, on this machine or another with the same file system.
    """
    folder.mkdir(parents=True, exist_ok=True)
    held = _hold(folder / NAME)
    if held is None:
        raise InputError(f"another run trains in {folder} now; give another --trainer.default_root_dir.")
    try:
        yield
    finally:
        (folder / NAME).unlink(missing_ok=True)  # while it is held: nobody can take it between
        os.close(held)


def _hold(path: Path) -> int | None:
    """Return a file's descriptor, locked, or None if another process has it."""
    while True:
        held = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # A run that ended just now may have taken the name away from what was opened.
            if path.exists() and os.path.samestat(os.fstat(held), path.stat()):
                return held
        except BlockingIOError:
            os.close(held)
            return None
        except BaseException:
            os.close(held)
            raise
        os.close(held)
