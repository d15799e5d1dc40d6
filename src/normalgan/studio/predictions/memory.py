"""Memory: have the C library keep the memory of one map for the next."""

import ctypes
import platform

__all__ = ["keep_memory"]

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
"""Of glibc's malloc.h."""
_LARGEST = 2**25
"""Bytes of the largest array that is put into kept memory; glibc allows no more."""
_KEPT = 2**28
"""Bytes that are kept; the rest is given back to the system."""


def keep_memory() -> bool:
    """Have glibc keep freed memory; return whether it does.

    By default glibc gives large arrays back to the system when they are freed, and each thread has its own
    memory. The next map must then fault it in page by page: at 1024 pixels, a sixth of a stroke's time.
    Other C libraries are left as they are.
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = ctypes.CDLL(None).mallopt
    settings = ((_ARENA_MAX, 1), (_MMAP_THRESHOLD, _LARGEST), (_TRIM_THRESHOLD, _KEPT))
    return all(mallopt(name, value) == 1 for name, value in settings)
