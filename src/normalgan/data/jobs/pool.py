"""Pool: runs tasks in parallel, in processes of one or many machines."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

T = TypeVar("T")
R = TypeVar("R")

_LOSSES = 5  # number of lost results after which a task is assumed to kill its worker


@dataclass(frozen=True)
class Killed:
    """The result of a task that killed its worker, or that shares a name with such a task."""


@dataclass(frozen=True)
class Again:
    """The result of a task that must be repeated.

    Args:
        lost: whether the result was lost, which the task itself may have caused.
    """

    lost: bool


class Pool(ABC):
    """Runs tasks in processes, and continues when a process dies.

    Subclasses start, query and replace the processes of this machine or of a cluster.
    """

    @property
    @abstractmethod
    def room(self) -> int:
        """Maximum number of submitted tasks."""

    @abstractmethod
    def submit(self, function: Callable[[T], R], task: T) -> Any:
        """Start a task and return its future."""

    @abstractmethod
    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        """Wait for a while until a future is done, and return all that are done.

        Raises:
            RunError: if no worker is left.
        """

    @abstractmethod
    def outcome(self, future: Any) -> Any:
        """Return the result of a finished task, or `Killed` or `Again`; raise the task's own error."""

    @abstractmethod
    def cancel(self, under_way: Collection[Any]) -> None:
        """Cancel tasks with results that are no longer needed."""

    def run(
        self,
        function: Callable[[T], R],
        tasks: Iterable[T],
        related: Callable[[T], Collection[str]] = lambda _: (),
    ) -> Iterator[tuple[T, R | Killed]]:
        """Yield each task with its result when it is finished, in any order.

        Args:
            function: module-level function, so that a worker can import it.
            tasks: arguments of the function.
            related: function that returns the names of a task, by default none. After a task was killed,
                tasks that share a name with it are not started but yielded as killed.

        Raises:
            InputError: if a task raises one; results of earlier tasks are already yielded or written.
            RunError: if no worker is left; tasks that finished earlier were yielded or written.
        """
        todo = deque((task, 0) for task in tasks)  # with the number of lost results
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
        """Return the result of a task that runs alone, so that the task is to blame if the worker dies."""
        ((_, outcome),) = self.run(function, [task])
        return outcome
