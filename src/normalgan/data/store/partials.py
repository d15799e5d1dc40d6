"""Partials: names of half-written files that tell whether their writer is still there."""

import hashlib
import os
import platform
import time
import uuid
from functools import cache
from pathlib import Path

__all__ = ["abandoned", "partial_name"]

_LONG = 3600.0
"""Seconds; nothing takes an hour to write."""


def partial_name() -> str:
    """Return a new name, which says who writes: machine, process, and which of its files."""
    return f"{_here()}.{os.getpid()}.{uuid.uuid4().hex}"


def abandoned(path: Path) -> bool:
    """Whether nobody writes a file any more: its process is gone from this machine, or it is an hour old.

    Raises:
        OSError: if it cannot be looked at.
    """
    here, _, rest = path.name.partition(".")
    number = rest.partition(".")[0]
    if here == _here() and number.isdecimal() and not _runs(int(number)):
        return True
    return time.time() - path.stat().st_mtime > _LONG


@cache
def _here() -> str:
    """Return a name for where processes are numbered: a machine, or a container on it."""
    numbering = Path("/proc/self/ns/pid")  # Linux: two containers may have one name, and other processes
    where = f"{platform.node()} {numbering.readlink() if numbering.is_symlink() else ''}"
    return hashlib.sha256(where.encode()).hexdigest()[:12]


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)  # asks only
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # of another user
        pass
    return True
