"""Pipeline: drawings prepared, painted and written at once, so that the model seldom waits."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

J = TypeVar("J")
A = TypeVar("A")
B = TypeVar("B")
R = TypeVar("R")

_AHEAD = 3
"""Drawings that are prepared before the model has come to them: few, as large ones fill the memory."""


def stream(
    jobs: Sequence[J], before: Callable[[J], A], middle: Callable[[A], B], after: Callable[[J, A, B], R]
) -> Iterator[tuple[J, R | Exception]]:
    """Yield each job with what came of it, or the exception that stopped it, in order.

    ``before`` runs in a thread some jobs ahead, ``after`` in another behind, ``middle`` here.

    >>> list(stream([1, 2], lambda j: j + 1, lambda a: a * 10, lambda j, a, b: (j, a, b)))
    [(1, (1, 2, 20)), (2, (2, 3, 30))]
    """
    with ThreadPoolExecutor(1) as first, ThreadPoolExecutor(1) as last:
        waiting: deque[Future[A]] = deque()
        ending: deque[tuple[J, Future[R]]] = deque()
        ahead = iter(jobs)
        try:
            for job in jobs:
                while len(waiting) < _AHEAD and (nxt := next(ahead, None)) is not None:
                    waiting.append(first.submit(before, nxt))
                try:
                    ready = waiting.popleft().result()
                    ending.append((job, last.submit(after, job, ready, middle(ready))))
                except Exception as error:
                    stopped: Future[R] = Future()
                    stopped.set_exception(error)
                    ending.append((job, stopped))
                yield from _drained(ending, _AHEAD)
            yield from _drained(ending, 0)
        finally:
            for future in waiting:
                future.cancel()


def _drained(ending: deque[tuple[J, Future[R]]], left: int) -> Iterator[tuple[J, R | Exception]]:
    """Yield what came of the first jobs, once it is there, until so many are left."""
    while len(ending) > left:
        job, outcome = ending.popleft()
        failure = outcome.exception()
        if isinstance(failure, Exception):
            yield job, failure
        else:
            yield job, outcome.result()
