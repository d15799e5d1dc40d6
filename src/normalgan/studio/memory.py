"""Memory: what the C library does with memory that was used for a map, and will be for the next one."""

import ctypes
import platform

__all__ = ["keep_memory"]

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
"""Of glibc's malloc.h."""
_LARGEST = 2**25
"""Bytes of the largest array that is taken from memory that was kept; glibc allows no more."""
_KEPT = 2**28
"""Bytes that are kept; more is given back to the system."""


def keep_memory() -> bool:
    """Have memory kept from one map to the next; return whether that is so.

    By default glibc gives large arrays back to the system as soon as they are freed, and each thread has
    memory of its own. The next map then takes it anew, page by page: thousands of pages at 1024 pixels, for
    which the thread that paints has to wait. Other C libraries are left as they are.
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = ctypes.CDLL(None).mallopt
    settings = ((_ARENA_MAX, 1), (_MMAP_THRESHOLD, _LARGEST), (_TRIM_THRESHOLD, _KEPT))
    return all(mallopt(name, value) == 1 for name, value in settings)
