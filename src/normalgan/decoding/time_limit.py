"""A time limit for code that another thread can end."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def time_limit(seconds: float, end: Callable[[], object]) -> Iterator[threading.Event]:
    """Call a function from another thread if the block takes longer than ``seconds``.

    The event that the block gets is set before the call.
    """
    late = threading.Event()

    def ring() -> None:
        late.set()
        end()

    clock = threading.Timer(seconds, ring)
    clock.daemon = True
    clock.start()
    try:
        yield late
    finally:
        clock.cancel()
