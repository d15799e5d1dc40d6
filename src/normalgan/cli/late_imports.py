"""Late imports: heavy libraries, imported where they are needed, without looking for garbage meanwhile."""

import atexit
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["gc_paused"]


@contextmanager
def gc_paused() -> Iterator[None]:
    """Switch the garbage collector off during imports, and exclude their objects from later runs.

    Modules make a million objects that stay. Searching them for garbage takes a fifth of the time to import
    Lightning and parse a command.

    >>> with gc_paused():
    ...     gc.isenabled()
    False
    """
    enabled, known = gc.isenabled(), len(sys.modules)
    gc.disable()
    try:
        yield
    finally:
        if len(sys.modules) > known:  # otherwise garbage would be kept for nothing
            gc.freeze()
            # Triton 3.9, which comes with PyTorch 2.15 for GPUs, reports frozen objects as leaked at exit.
            if "triton" in sys.modules:  # unfreezing takes a second
                atexit.register(gc.unfreeze)
        if enabled:
            gc.enable()
