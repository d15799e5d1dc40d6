"""Run jobs in parallel threads."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

J = TypeVar("J")
R = TypeVar("R")

_MOST = 8
"""Maximum number of drawings at once, because large drawings fill the memory."""


def workers(jobs: int) -> int:
    """Return the number of jobs to run at once: one more than the number of cores.

    One job is usually waiting for the disk or for its drawing to be decoded.
    """
    # The scheduler's count, if available, because a container may have fewer cores than its machine.
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(min(cores + 1, jobs, _MOST), 1)


def stream(jobs: Sequence[J], work: Callable[[J], R]) -> Iterator[tuple[J, R | Exception]]:
    """Yield each job, in order, with its result or the exception that stopped it.

    Each thread runs whole jobs. NumPy, OpenCV and ONNX Runtime release the GIL while they compute, so threads
    with single-threaded networks keep all cores busy. A multi-threaded network would wait for the serial
    parts of each job.

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
        # Running jobs are not waited for. If the caller stops early, this generator is closed by the garbage
        # collector in an arbitrary thread. If that thread were just starting, it would deadlock, because
        # joining takes a lock that it already holds. The interpreter waits for all threads at exit.
        pool.shutdown(wait=False, cancel_futures=True)


def result_of(outcome: R | Exception) -> R:
    """Return a result from `stream`, or raise it if it is an exception."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _drained(waiting: deque[tuple[J, Future[R]]], left: int) -> Iterator[tuple[J, R | Exception]]:
    """Yield the results of the oldest jobs until only ``left`` jobs are waiting."""
    while len(waiting) > left:
        job, future = waiting.popleft()
        failure = future.exception()
        if isinstance(failure, Exception):
            yield job, failure
        else:
            yield job, future.result()
