"""Cluster: worker processes on many machines, connected through a Dask scheduler."""

import logging
import re
import time
import warnings
from collections.abc import Callable, Collection
from concurrent.futures import CancelledError
from contextlib import ExitStack, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from types import TracebackType
from typing import Any, Self, TypeVar
from uuid import uuid4

from normalgan.data.jobs.cluster_worker import Unfit, flaws, order
from normalgan.data.jobs.pool import Again, Killed, Pool
from normalgan.data.jobs.workers import one_thread_each
from normalgan.data.store.fsspec_storage import reason
from normalgan.errors import InputError, RunError
from normalgan.warning_filters import quiet_loggers

T = TypeVar("T")
R = TypeVar("R")

_CHECK_INTERVAL = 1.0  # seconds between two checks of the workers
_NO_WORKER_TIMEOUT = 60.0  # seconds without any worker, after which rendering ends


class Cluster(Pool):
    """The workers of a Dask cluster.

    If a worker dies, the scheduler reassigns its tasks; new workers get tasks too. All workers must have
    the same versions of normalgan and of the packages that affect the bytes of samples, and a single
    thread.

    Dask futures are used directly, because the executor of `Client.get_executor` does not distinguish a
    lost result, a cancelled one and a lost scheduler.

    Args:
        where: ``tcp://host:port`` of a scheduler, a scheduler file ``….json``, or ``local:N`` for N
            processes on this machine.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self._stack = ExitStack()
        self._client: Any = None
        self._workers: set[str] = set()
        self._refused: set[str] = set()
        self._checked_at = self._worker_seen_at = 0.0
        self._ended: SimpleQueue[Any] = SimpleQueue()

    def __enter__(self) -> Self:
        """Connect, and wait for a worker.

        Raises:
            InputError: if the cluster cannot be reached, or a worker is unfit.
            RunError: if no worker joins.
        """
        with ExitStack() as stack:
            self._client = _connect(self.where, stack)
            self._worker_seen_at = time.monotonic()
            while not self._workers:
                for address, flaw in self._update_workers().items():
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
        """Three tasks per worker, enough to keep it busy and few enough to lose when it dies."""
        return 3 * len(self._workers)

    def submit(self, function: Callable[[T], R], task: T) -> Any:
        """Submit a task."""
        # A new key, because for a known key the scheduler returns the old result or failure.
        key = f"normalgan-{function.__name__}-{uuid4().hex}"
        future = self._client.submit(eval, *order(function, task), key=key, pure=False)
        future.add_done_callback(self._ended.put)
        return future

    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        """Wait up to a second for a task to finish, and update the list of workers."""
        try:
            ended = {self._ended.get(timeout=_CHECK_INTERVAL)}
        except Empty:
            ended = set()
        if time.monotonic() - self._checked_at >= _CHECK_INTERVAL:
            self._refuse_unfit()
        return ended & set(under_way)

    def outcome(self, future: Any) -> Any:
        """Return the result of a task, or `Again` if the result is lost or its worker is unfit."""
        from distributed import KilledWorker

        if future.status == "error":
            error = future.exception()
            if isinstance(error, KilledWorker):
                return Killed()
            # An unfit worker may have failed to unpack the task.
            if not isinstance(error, InputError) and self._refuse_unfit():
                return Again(lost=False)
            raise error
        if future.status != "finished":
            return self._lost_result()
        try:
            result = future.result()
        except KilledWorker:  # the result was lost, and the task killed each worker that retried it
            return Killed()
        except CancelledError:
            return self._lost_result()
        except OSError as cause:  # an error of the connection; errors of the task have the status "error"
            raise self._scheduler_gone() from cause
        if isinstance(result, Unfit):
            self._refuse_unfit()
            return Again(lost=False)
        return result

    def cancel(self, under_way: Collection[Any]) -> None:
        """Cancel tasks with results that are no longer needed."""
        if self._client.status == "running":
            with suppress(OSError):  # the scheduler may just have stopped
                self._client.cancel(list(under_way), force=True)

    def _lost_result(self) -> Again:
        """Return `Again` if the result was lost with its worker, or the connection broke and was restored.

        Raises:
            RunError: if the connection is lost.
        """
        if not self._is_connected():
            raise self._scheduler_gone()
        return Again(lost=True)

    def _is_connected(self) -> bool:
        """Return whether there is a connection, after Dask has restored a broken one or given up."""
        deadline = time.monotonic() + _TIMEOUT + _CHECK_INTERVAL
        while self._client.status == "connecting" and time.monotonic() < deadline:
            time.sleep(0.05)
        return bool(self._client.status == "running")

    def _refuse_unfit(self) -> bool:
        """Update the list of workers, refuse unfit new ones, and return whether there were any."""
        unfit = self._update_workers()
        for address, flaw in unfit.items():
            warnings.warn(f"the worker {address} has joined but cannot be used: it has {flaw}.", stacklevel=2)
        if unfit:
            self._refused |= set(unfit)
            self._client.retire_workers(list(unfit))
        return bool(unfit)

    def _update_workers(self) -> dict[str, str]:
        """Update the list of workers, and return the flaws of new ones by address.

        Raises:
            RunError: if the connection is lost, or there has been no worker for too long.
        """
        self._checked_at = time.monotonic()
        if not self._is_connected():
            raise self._scheduler_gone()
        present = self._client.scheduler_info(n_workers=-1)["workers"]
        new = set(present) - self._workers - self._refused
        unfit = flaws(self._client, {address: present[address]["nthreads"] for address in new})
        self._workers = set(present) - set(unfit) - self._refused
        if self._workers or unfit:
            self._worker_seen_at = self._checked_at
        elif self._checked_at - self._worker_seen_at > _NO_WORKER_TIMEOUT:
            raise RunError(
                f"there has been no worker at {self.where} for {_NO_WORKER_TIMEOUT:.0f} seconds; what is "
                "finished is kept: start workers, and run again."
            )
        return unfit

    def _scheduler_gone(self) -> RunError:
        return RunError(
            f"the scheduler at {self.where} is gone; finished samples are kept: start it, and run again."
        )


_TIMEOUT = 10.0
"""Timeout for a scheduler's answer in seconds."""

_FORMS = "tcp://host:port, a scheduler file (.json) or local:N"
_LOCAL = {
    # A mesh that kills its worker is retried alone, so two deaths are enough, not Dask's four.
    "distributed.scheduler.allowed-failures": 1,
    # LocalCluster gives up workers that do not restart in time; its 15 s are too short on a busy machine.
    "distributed.deploy.lost-worker-timeout": "10 minutes",
}


def _connect(where: str, stack: ExitStack) -> Any:
    """Return a client of the cluster.

    Args:
        where: address, as for `Cluster`.
        stack: exit stack that closes the client and a local cluster.

    Raises:
        InputError: if Dask is not installed, the address is invalid, or no scheduler answers.
    """
    try:
        import dask.config
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError("a cluster needs Dask: pip install 'normalgan[cluster]'.") from error
    # Lost workers are reported by our own messages or do not matter.
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    stack.enter_context(quiet_loggers(*names))
    address: Any = where
    settings: dict[str, str] = {}
    if found := re.fullmatch(r"local:(\d+)", where):
        if int(found[1]) < 1:
            raise InputError(f"the cluster {where} has no worker; local:2 has two.")
        stack.enter_context(dask.config.set(_LOCAL))
        with one_thread_each():
            made: Any = LocalCluster(  # type: ignore[no-untyped-call]
                n_workers=int(found[1]), threads_per_worker=1, processes=True, dashboard_address=":0"
            )
        address = stack.enter_context(made)
    elif where.endswith(".json"):
        if not Path(where).is_file():
            raise InputError(
                f"there is no scheduler file {where}; dask scheduler --scheduler-file writes it."
            )
        address, settings = None, {"scheduler_file": where}
    elif not re.fullmatch(r"(\w+://)?[^/\s]+:\d+", where):
        raise InputError(f"{where!r} names no cluster; give {_FORMS}.")
    try:
        client: Any = Client(address, timeout=_TIMEOUT, set_as_default=False, **settings)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:  # no answer; no such protocol, no scheduler file
        raise InputError(
            f"no scheduler answers at {where} within {_TIMEOUT:.0f} seconds ({reason(error)}); is it "
            "running, and is the address right?"
        ) from error
    return stack.enter_context(client)
