"""Memory: make the C library keep freed memory, so that the next map can reuse it."""

import ctypes
import platform

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8
"""Parameters of mallopt in glibc's malloc.h."""
_LARGEST = 2**25
"""Size in bytes of the largest allocation that uses kept memory; this is glibc's maximum."""
_KEPT = 2**28
"""Number of free bytes that are kept; the rest is returned to the system."""


def keep_memory() -> bool:
    """Configure glibc to keep freed memory; return whether it does.

    By default, glibc returns large arrays to the system when they are freed, and each thread has its own
    arena. The next map must then fault its memory in page by page, which takes a sixth of a stroke's time at
    1024 pixels. Other C libraries are not changed.
    """
    if platform.libc_ver()[0] != "glibc":
        return False
    mallopt = ctypes.CDLL(None).mallopt
    settings = ((_ARENA_MAX, 1), (_MMAP_THRESHOLD, _LARGEST), (_TRIM_THRESHOLD, _KEPT))
    return all(mallopt(name, value) == 1 for name, value in settings)
