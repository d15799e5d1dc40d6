"""Pool: whoever does work side by side, processes of this machine or of many."""

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

__all__ = ["Killed", "Pool", "alone", "unrelated"]

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True)
class Killed:
    """What comes of a task whose worker died, and died again when it was tried anew; or of one akin to it."""


class Pool(Protocol):
    """Does tasks side by side."""

    def run(
        self, function: Callable[[T], R], tasks: Iterable[T], related: Callable[[T], Collection[str]] = ...
    ) -> Iterator[tuple[T, R | Killed]]:
        """Yield every task with its result as it is finished, in no particular order.

        Args:
            function: of a module, so that a worker can import it.
            tasks: what it is called with.
            related: names that a task shares with others of its kind. Once one was killed, those that share a
                name with it are not begun any more, and yielded as killed.

        Raises:
            RunError: if there is nobody left to work; what is finished by then has been yielded or written.
        """


def unrelated(_: object) -> tuple[str, ...]:
    """Return no names: every task stands for itself."""
    return ()


def alone(pool: Pool, function: Callable[[T], R], task: T) -> R | Killed:
    """Return what comes of a task while nothing else is done: if its worker dies, it is to blame."""
    ((_, outcome),) = pool.run(function, [task])
    return outcome
