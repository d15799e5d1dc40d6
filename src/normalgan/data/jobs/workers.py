"""Workers: parallel processes that end with their parent and use one core each."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait
from types import TracebackType
from typing import Self, TypeVar

from normalgan.data.jobs.main_guard import check_main_guard
from normalgan.data.jobs.pool import unrelated
from normalgan.errors import InputError, RunError

__all__ = ["Workers", "one_thread_each"]

T = TypeVar("T")
R = TypeVar("R")

# One thread each: as many workers as cores would otherwise start cores² threads. 0 for llvmpipe, which
# counts the threads it starts besides its caller's.
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENCV_FOR_THREADS_NUM": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "LP_NUM_THREADS": "0",
}


class Workers:
    """A pool of spawned processes; with none, this process does one task after another.

    Spawned, not forked: a process forked after an OpenGL context was made hangs when it renders.

    Args:
        count: number of processes; 0 for this one alone.

    Raises:
        InputError: if the count is negative.
    """

    def __init__(self, count: int) -> None:
        if count < 0:
            raise InputError(
                f"{count} workers are asked for; it must be 0 (none besides this process) or more."
            )
        self.count = count
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    def run(
        self,
        function: Callable[[T], R],
        tasks: Iterable[T],
        related: Callable[[T], Collection[str]] = unrelated,
    ) -> Iterator[tuple[T, R]]:
        """Yield every task with its result when it is finished, in any order.

        Args:
            function: of a module, so that a worker can import it.
            tasks: what it is called with.
            related: unused; see `Pool`. When a worker dies, all tasks end.

        Raises:
            RunError: if a worker dies; finished tasks have been yielded or written by then.
        """
        tasks = list(tasks)
        if not self.count:
            for task in tasks:
                yield task, function(task)
            return
        with one_thread_each():
            if self._pool is None:
                check_main_guard()
                context = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(self.count, mp_context=context, initializer=_prepare)
            futures = {self._pool.submit(function, task): task for task in tasks}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BrokenProcessPool as error:
            raise RunError(
                f"one of the {self.count} worker processes was killed, most likely for want of memory; "
                "what is finished is kept: run again, with fewer workers."
            ) from error


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Inside this context, new processes compute in one thread."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    # Set here, not in the worker: the libraries read it when they are loaded, before any code of ours.
    os.environ.update(_ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _prepare() -> None:
    # Ctrl-C reaches the whole group: the parent then lets every worker finish what it is writing.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_die_with, args=(parent.sentinel,), daemon=True).start()


def _die_with(sentinel: int) -> None:
    # A killed parent closes no queue: its workers would wait on it for ever.
    wait([sentinel])
    os._exit(1)
