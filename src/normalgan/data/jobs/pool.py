"""Pool: the interface of parallel work, on one machine or many."""

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

__all__ = ["Killed", "Pool", "alone", "unrelated"]

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True)
class Killed:
    """The result of a task that killed its worker twice, or that shares a name with such a task."""


class Pool(Protocol):
    """Does tasks in parallel."""

    def run(
        self, function: Callable[[T], R], tasks: Iterable[T], related: Callable[[T], Collection[str]] = ...
    ) -> Iterator[tuple[T, R | Killed]]:
        """Yield every task with its result when it is finished, in any order.

        Args:
            function: of a module, so that a worker can import it.
            tasks: what it is called with.
            related: names that tasks share. After one is killed, tasks that share a name with it are not
                started, and yielded as killed.

        Raises:
            RunError: if no worker is left; finished tasks have been yielded or written by then.
        """


def unrelated(_: object) -> tuple[str, ...]:
    """Return no names: every task stands for itself."""
    return ()


def alone(pool: Pool, function: Callable[[T], R], task: T) -> R | Killed:
    """Return the result of a task that runs alone; if its worker dies, the task is the cause."""
    ((_, outcome),) = pool.run(function, [task])
    return outcome
