"""One thread each: what keeps processes that work side by side from taking each other's cores."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

# As many workers as cores would otherwise start cores² threads. 0 for llvmpipe, which counts the threads it
# starts besides its caller's.
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "LP_NUM_THREADS": "0",
}


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Let the processes that are started here use one thread each.

    By the environment they are born into, not by code of theirs: the libraries read it when they are loaded.
    """
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(_ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})
