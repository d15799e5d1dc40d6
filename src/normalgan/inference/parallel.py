"""Run jobs in parallel, one thread each."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

__all__ = ["result_of", "stream", "workers"]

J = TypeVar("J")
R = TypeVar("R")

_MOST = 8
"""Drawings at once: few, as large ones fill the memory."""


def workers(jobs: int) -> int:
    """Return the number of jobs to run at once: one more than the cores.

    One of them is usually waiting for the disk, or for its drawing to be decoded.
    """
    # The scheduler's own count where there is one: a container may have fewer cores than its machine.
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(min(cores + 1, jobs, _MOST), 1)


def stream(jobs: Sequence[J], work: Callable[[J], R]) -> Iterator[tuple[J, R | Exception]]:
    """Yield each job with its result, or the exception that stopped it, in order.

    Each thread does whole jobs. NumPy, OpenCV and ONNX Runtime release the lock while they compute, so
    threads with one-core networks keep all cores busy. A network over all cores would wait for the serial
    rest of each job.

    >>> list(stream([1, 2], lambda job: {2: 10}[job]))
    [(1, KeyError(1)), (2, 10)]
    """
    count = workers(len(jobs))
    pool = ThreadPoolExecutor(count)
    waiting: deque[tuple[J, Future[R]]] = deque()
    try:
        for job in jobs:
            waiting.append((job, pool.submit(work, job)))
            yield from _drained(waiting, count)
        yield from _drained(waiting, 0)
    finally:
        # What is under way is not waited for. Who leaves early, as by an exception, leaves this to be
        # collected with it, in whatever thread that happens: one that is just starting would wait for itself
        # for ever, as joining takes the lock that it holds. The interpreter waits for all before it ends.
        pool.shutdown(wait=False, cancel_futures=True)


def result_of(outcome: R | Exception) -> R:
    """Return the result of a job of `stream`; raise the exception if that is its outcome."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _drained(waiting: deque[tuple[J, Future[R]]], left: int) -> Iterator[tuple[J, R | Exception]]:
    """Yield the results of the first jobs as they finish, until a number is left."""
    while len(waiting) > left:
        job, future = waiting.popleft()
        failure = future.exception()
        if isinstance(failure, Exception):
            yield job, failure
        else:
            yield job, future.result()
