"""Cluster: processes on many machines, through a Dask scheduler."""

import time
import warnings
from collections.abc import Callable, Collection
from concurrent.futures import CancelledError
from contextlib import ExitStack, suppress
from queue import Empty, SimpleQueue
from types import TracebackType
from typing import Any, Self, TypeVar
from uuid import uuid4

from normalgan.data.jobs.cluster_address import TIMEOUT, connect
from normalgan.data.jobs.cluster_worker import Unfit, flaws, order
from normalgan.data.jobs.pool import Again, Killed, Pool
from normalgan.errors import InputError, RunError

__all__ = ["Cluster"]

T = TypeVar("T")
R = TypeVar("R")

_LOOK = 1.0  # seconds between two looks at who is there
_PATIENCE = 60.0  # seconds without any worker, after which it ends


class Cluster(Pool):
    """The workers of a Dask cluster.

    If a worker dies, the scheduler gives its tasks to others; a new worker gets its share. Each must have the
    same versions of normalgan and of the packages that the bytes depend on, and one thread.

    Args:
        where: which cluster; see `connect`.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self._stack = ExitStack()
        self._client: Any = None
        self._workers: set[str] = set()
        self._sent_away: set[str] = set()
        self._looked = self._seen = 0.0
        self._ended: SimpleQueue[Any] = SimpleQueue()

    def __enter__(self) -> Self:
        """Connect, and check the workers.

        Raises:
            InputError: if the cluster cannot be reached, or a worker is unfit.
            RunError: if no worker comes.
        """
        with ExitStack() as stack:
            self._client = connect(self.where, stack)
            self._seen = time.monotonic()
            while not self._workers:
                for address, flaw in self._look().items():
                    raise InputError(f"the worker {address} of {self.where} cannot be used: it has {flaw}.")
                if not self._workers:
                    time.sleep(0.1)
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    @property
    def room(self) -> int:
        """Three tasks a worker: enough to keep it busy, and few to lose when it dies."""
        return 3 * len(self._workers)

    def submit(self, function: Callable[[T], R], task: T) -> Any:
        """Submit a task."""
        # Never used before: of a known key the scheduler gives the old result, or the old death.
        key = f"normalgan-{function.__name__}-{uuid4().hex}"
        future = self._client.submit(eval, *order(function, task), key=key, pure=False)
        future.add_done_callback(self._ended.put)
        return future

    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        """Wait up to a second for a task to end, and update the list of workers."""
        future = _next(self._ended)
        self._watch()
        return [future] if future in under_way else []

    def outcome(self, future: Any) -> Any:
        """Return the result of a task, or `Again` if the result is lost or its worker is unfit."""
        from distributed import KilledWorker

        if future.status == "finished":
            try:
                outcome = future.result()
            except KilledWorker:  # the result died with its worker, and so did those that made it again
                return Killed()
            except CancelledError:
                return self._lost_result()
            except OSError as cause:  # on the way, not of the task: that one would have ended in an error
                raise self._lost() from cause
            if not isinstance(outcome, Unfit):
                return outcome
            self._watch(at_once=True)
            return Again(lost=False)
        if future.status != "error":
            return self._lost_result()
        error = future.exception()
        if isinstance(error, KilledWorker):
            return Killed()
        if not isinstance(error, InputError) and self._watch(at_once=True):
            return Again(lost=False)  # it could not even unpack what it was to do
        raise error

    def cancel(self, under_way: Collection[Any]) -> None:
        """Cancel tasks whose results are not needed."""
        if self._client.status == "running":
            with suppress(OSError):  # the scheduler may have gone a moment ago
                self._client.cancel(list(under_way), force=True)

    def _lost_result(self) -> Again:
        """Return `Again`: the result was lost with its worker, or the connection broke and was restored.

        Raises:
            RunError: if the connection is lost.
        """
        if not self._connected():
            raise self._lost()
        return Again(lost=True)

    def _connected(self) -> bool:
        """Return whether there is a connection; Dask restores a broken one or gives up."""
        deadline = time.monotonic() + TIMEOUT + _LOOK
        while self._client.status == "connecting" and time.monotonic() < deadline:
            time.sleep(0.05)
        return bool(self._client.status == "running")

    def _watch(self, at_once: bool = False) -> bool:
        """Update the list of workers; return whether one was refused."""
        if not at_once and time.monotonic() - self._looked < _LOOK:
            return False
        unfit = self._look()
        for address, flaw in unfit.items():
            warnings.warn(f"the worker {address} has joined but cannot be used: it has {flaw}.", stacklevel=2)
        if unfit:
            self._sent_away |= set(unfit)
            self._client.retire_workers(list(unfit))
        return bool(unfit)

    def _look(self) -> dict[str, str]:
        """Update the list of workers; return the flaws of new ones, by address."""
        self._looked = time.monotonic()
        if not self._connected():
            raise self._lost()
        there = self._client.scheduler_info(n_workers=-1)["workers"]
        known = self._workers | self._sent_away
        unfit = flaws(self._client, {a: there[a]["nthreads"] for a in there if a not in known})
        self._workers = set(there) - set(unfit) - self._sent_away
        if self._workers or unfit:
            self._seen = self._looked
        elif self._looked - self._seen > _PATIENCE:
            raise RunError(
                f"there has been no worker at {self.where} for {_PATIENCE:.0f} seconds; what is "
                "finished is kept: start workers, and run again."
            )
        return unfit

    def _lost(self) -> RunError:
        return RunError(
            f"the scheduler at {self.where} is gone; finished samples are kept: start it, and run again."
        )


def _next(ended: "SimpleQueue[Any]") -> Any:
    try:
        return ended.get(timeout=_LOOK)
    except Empty:
        return None
