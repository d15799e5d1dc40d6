"""Workers: local processes that end with their parent and use one core each."""

import ast
import inspect
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor
from concurrent.futures import wait as wait_for
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.errors import InputError

T = TypeVar("T")
R = TypeVar("R")

# One thread each, because one worker per core would otherwise start cores² threads. llvmpipe needs 0,
# because it does not count the caller's thread.
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENCV_FOR_THREADS_NUM": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "LP_NUM_THREADS": "0",
}


class Workers(Pool):
    """A pool of spawned processes; with a count of 0, tasks run in this process.

    Processes are spawned, because a process that is forked after an OpenGL context was created hangs when
    it renders.

    Args:
        count: number of processes; 0 to use only this one.

    Raises:
        InputError: if the count is negative.
    """

    def __init__(self, count: int) -> None:
        if count < 0:
            raise InputError(f"{count} workers were requested; use 0 (only this process) or more.")
        self.count = count
        self._pool: ProcessPoolExecutor | None = None  # unusable after one of its processes died
        self._pools: dict[Any, ProcessPoolExecutor] = {}  # by future

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    @property
    def room(self) -> int:
        """The maximum number of submitted tasks, two per worker: enough to keep it busy, and few to lose."""
        return max(2 * self.count, 1)

    def submit(self, function: Callable[[T], R], task: T) -> "Future[R]":
        """Start a task; without worker processes, run it immediately."""
        if not self.count:
            done: Future[R] = Future()
            done.set_result(function(task))
            return done
        with one_thread_each():
            while True:
                if self._pool is None:
                    check_main_guard()
                    context = multiprocessing.get_context("spawn")
                    self._pool = ProcessPoolExecutor(self.count, mp_context=context, initializer=_prepare)
                try:
                    future = self._pool.submit(function, task)
                except BrokenProcessPool:  # a process has just died
                    self._discard(self._pool)
                else:
                    self._pools[future] = self._pool
                    return future

    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        """Wait until a task is done."""
        return wait_for(under_way, return_when=FIRST_COMPLETED).done

    def outcome(self, future: "Future[R]") -> R | Killed:
        """Return the result of a task; if a worker died, all tasks in the pool return `Killed`."""
        pool = self._pools.pop(future, None)
        try:
            return future.result()
        except BrokenProcessPool:
            if pool is not None:
                self._discard(pool)
            return Killed()

    def cancel(self, under_way: Collection[Any]) -> None:
        """Cancel the tasks that no process has started."""
        for future in under_way:
            future.cancel()
            self._pools.pop(future, None)

    def _discard(self, pool: ProcessPoolExecutor) -> None:
        pool.shutdown(wait=True, cancel_futures=True)
        if self._pool is pool:
            self._pool = None


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Limit new processes to one thread within the context."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    # Set in the parent, because libraries read it when a worker imports them, before our code runs.
    os.environ.update(_ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def leave_signals_to_parent() -> None:
    """Ignore Ctrl-C and SLURM's SIGUSR1, which reach all processes; the parent lets each finish writing."""
    for name in ("SIGINT", "SIGUSR1"):
        if hasattr(signal, name):  # Windows has no SIGUSR1
            signal.signal(getattr(signal, name), signal.SIG_IGN)


def _prepare() -> None:
    leave_signals_to_parent()
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_die_with, args=(parent.sentinel,), daemon=True).start()


def _die_with(sentinel: int) -> None:
    # A killed parent does not close the queue, so its workers would wait forever.
    wait([sentinel])
    os._exit(1)


def check_main_guard() -> None:
    """Check that the calling script has the guard ``if __name__ == "__main__":``.

    A spawned process imports the script again. Without the guard, it would itself start processes and
    fail.

    Raises:
        InputError: if the guard is missing; the message names the script and the line.
    """
    main = sys.modules.get("__main__")
    frame = inspect.currentframe()
    while frame is not None:
        again = frame.f_globals.get("__name__") == "__mp_main__"  # spawned
        if frame.f_code.co_name == "<module>" and (again or frame.f_globals is vars(main or sys)):
            script = frame.f_globals.get("__file__")  # an interactive session has no script
            if script is not None and (again or not _is_guarded(Path(script), frame.f_lineno)):
                raise InputError(
                    f"line {frame.f_lineno} of {script} starts processes, which import this script again; "
                    'put the lines that do something under `if __name__ == "__main__":`.'
                )
        frame = frame.f_back


def _is_guarded(script: Path, line: int) -> bool:
    """Return whether a line of a script is inside an ``if`` on the module's name or parent process."""
    try:
        tree = ast.parse(script.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return True  # no Python source, for example in a frozen program
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and node.lineno <= line <= (node.end_lineno or node.lineno):
            names = {each.id for each in ast.walk(node.test) if isinstance(each, ast.Name)}
            names |= {each.attr for each in ast.walk(node.test) if isinstance(each, ast.Attribute)}
            if names & {"__name__", "parent_process", "current_process"}:
                return True
    return False
