"""Late imports: pause the garbage collector while heavy libraries are imported."""

import atexit
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def gc_paused() -> Iterator[None]:
    """Pause the garbage collector during imports, and exclude the imported objects from later collections.

    Modules create a million permanent objects. Scanning them takes a fifth of the time needed to import
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
        if len(sys.modules) > known:  # without new modules, freezing would only keep garbage
            gc.freeze()
            # Triton 3.9, which comes with PyTorch 2.15 for GPUs, reports frozen objects as leaked at exit.
            if "triton" in sys.modules:  # only then, because unfreezing takes a second
                atexit.register(gc.unfreeze)
        if enabled:
            gc.enable()
