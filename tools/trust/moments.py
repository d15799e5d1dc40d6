"""Moments: when to kill, drawn so that those are many at which files change."""

from dataclasses import dataclass

import numpy as np

FRESH_EACH = 10
"""Every tenth kill is of a process that starts as a user's does; the others are of forked ones."""
FRESH, ANY, CHANGE = "any moment from the start of Python on", "any moment", "a change of a file"


@dataclass(frozen=True)
class Moment:
    """When a child gets SIGKILL: so many seconds after its start, or after something that it does.

    Args:
        seconds: to wait.
        change: if not 0, they count from this change of its folder by the process itself, from 1.
        files: if not 0, they count from when there are so many files in the folder, whoever wrote them.
    """

    seconds: float
    change: int = 0
    files: int = 0


@dataclass(frozen=True)
class Draw:
    """Draws moments from those of a command that was not killed.

    Args:
        rng: where the choices come from.
        fresh: seconds that it took as a fresh process.
        forked: seconds that it took as a forked one.
        changes: of its folder that it made by itself.
        files: that it left, if others wrote them for it.
    """

    rng: np.random.Generator
    fresh: float
    forked: float
    changes: int
    files: int = 0

    def moment(self, number: int, done: float = 0.0) -> tuple[str, Moment]:
        """Return the kind of the moment of a kill, and the moment.

        Args:
            number: of the kill, from 0.
            done: share of the work that kills before have left, so that few moments come too late.
        """
        if number % FRESH_EACH == FRESH_EACH - 1:
            return FRESH, Moment(self.rng.uniform(0, self.fresh))
        if number % 2:
            return ANY, Moment(self.rng.uniform(0, self.forked * (1 - done / 2)))  # half is starting
        if self.files:
            there = min(round(self.files * done), self.files - 1)
            return CHANGE, Moment(
                self.rng.uniform(0, 0.05), files=int(self.rng.integers(there, self.files)) + 1
            )
        wait = self.rng.uniform(0, 0.01) if self.rng.random() < 0.5 else 0.0
        to_come = max(1, round(self.changes * (1 - done)))
        return CHANGE, Moment(wait, change=int(self.rng.integers(to_come)) + 1)
