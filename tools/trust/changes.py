"""Changes: what a process does to the files of a folder, told before each by Python's audit events."""

import os
import signal
import sys
import threading
import time
from pathlib import Path

WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT
NAMED_BY_FIRST = {"os.rename", "os.remove"}  # not os.mkdir: most folders are there already


def changed(event: str, arguments: tuple[object, ...]) -> str | None:
    """Return the path that an audit event is about to change, or None.

    Events as in https://docs.python.org/3/library/audit_events.html; ``open`` also stands for ``os.open``.

    >>> changed("open", ("/a", "wb", os.O_WRONLY)), changed("open", ("/a", "rb", 0))
    ('/a', None)
    """
    if event == "open":
        path, _, flags = arguments
        if not isinstance(flags, int) or not flags & WRITES:
            return None
    elif event in NAMED_BY_FIRST:
        path = arguments[0]
    else:
        return None
    return os.fspath(path) if isinstance(path, str | Path) else None


def tell_changes(folder: Path, told: Path, kill_at: int = 0, seconds: float = 0.0) -> None:
    """Note each change below a folder before it is made, and kill this process at one of them.

    Nothing takes this back: it is for a process that does nothing else.

    Args:
        folder: with its path from the root on.
        told: where they are noted: event and path, a line each.
        kill_at: number of the change, from 1; 0 for none.
        seconds: to wait until then, while the change goes on; 0 kills before it is made.
    """
    notes = os.open(told, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    lock = threading.Lock()
    count = 0

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal count
        path = changed(event, arguments)
        if path is None or not path.startswith(f"{folder}/"):
            return
        with lock:
            count += 1
            now = count == kill_at
        os.write(notes, f"{event} {path}\n".encode())
        if now and seconds:
            threading.Thread(target=_kill_after, args=(seconds,), daemon=True).start()
        elif now:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)


def _kill_after(seconds: float) -> None:
    time.sleep(seconds)
    os.kill(os.getpid(), signal.SIGKILL)
