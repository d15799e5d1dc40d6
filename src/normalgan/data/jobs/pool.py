"""Pool: tasks side by side, in processes of one machine or many."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

__all__ = ["Again", "Killed", "Pool", "unrelated"]

T = TypeVar("T")
R = TypeVar("R")

_LOSSES = 5  # results of a task that may be lost, after which its worker is taken to be killed by it


@dataclass(frozen=True)
class Killed:
    """The result of a task that killed its worker, or that shares a name with such a task."""


@dataclass(frozen=True)
class Again:
    """The result of a task that must be repeated.

    Args:
        lost: whether its result was lost, which can be its own fault.
    """

    lost: bool


def unrelated(_: object) -> tuple[str, ...]:
    """Return nothing: no task has anything to do with another."""
    return ()


class Pool(ABC):
    """Does tasks in processes, and continues when one of them dies.

    Subclasses say how processes of this machine or of a cluster are started, asked and replaced.
    """

    @property
    @abstractmethod
    def room(self) -> int:
        """How many tasks may be under way."""

    @abstractmethod
    def submit(self, function: Callable[[T], R], task: T) -> Any:
        """Start a task; return its future."""

    @abstractmethod
    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        """Return those futures that have ended, after waiting a while for one.

        Raises:
            RunError: if no worker is left.
        """

    @abstractmethod
    def outcome(self, future: Any) -> Any:
        """Return the result of a task that has ended, `Killed` or `Again`; raise what the task raised."""

    @abstractmethod
    def cancel(self, under_way: Collection[Any]) -> None:
        """Give up tasks that nobody waits for any more."""

    def run(
        self,
        function: Callable[[T], R],
        tasks: Iterable[T],
        related: Callable[[T], Collection[str]] = unrelated,
    ) -> Iterator[tuple[T, R | Killed]]:
        """Yield every task with its result when it is finished, in any order.

        Args:
            function: a module's function, so that a worker can import it.
            tasks: what it is called with.
            related: the names of a task. After one is killed, tasks that share a name with it are not
                started, but yielded as killed too.

        Raises:
            InputError: as a task does; finished tasks have been yielded or written by then.
            RunError: if no worker is left; finished tasks have been yielded or written then too.
        """
        todo = deque((task, 0) for task in tasks)  # with how often its result was lost
        under_way: dict[Any, tuple[T, int]] = {}
        suspicious: set[str] = set()
        try:
            while todo or under_way:
                while todo and len(under_way) < self.room:
                    task, losses = todo.popleft()
                    if suspicious.isdisjoint(related(task)):
                        under_way[self.submit(function, task)] = task, losses
                    else:
                        yield task, Killed()
                for future in self.wait(under_way):
                    task, losses = under_way.pop(future)
                    outcome = self.outcome(future)
                    if isinstance(outcome, Again) and losses + outcome.lost <= _LOSSES:
                        todo.appendleft((task, losses + outcome.lost))
                        continue
                    if isinstance(outcome, Again | Killed):
                        outcome = Killed()
                        suspicious.update(related(task))
                    yield task, outcome
        finally:
            self.cancel(under_way)

    def alone(self, function: Callable[[T], R], task: T) -> R | Killed:
        """Return the result of a task that runs alone; if its worker dies, the task is the cause."""
        ((_, outcome),) = self.run(function, [task])
        return outcome
