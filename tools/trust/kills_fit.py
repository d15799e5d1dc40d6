"""Kills of training: at most an epoch is lost, every checkpoint loads, and a run ends as if nothing were."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nursery import Child, Moment
from tiny_runs import TinyRun

FRESH_EACH = 10
"""Every tenth kill is of a process that starts as a user's does; the others are of forked ones."""
FRESH, ANY, CHANGE = "any moment from the start of Python on", "any moment", "a change of a file"


@dataclass(frozen=True)
class Draw:
    """Draws moments.

    Args:
        rng: where the choices come from.
        fresh: how a fresh process did that was not killed.
        forked: the same of a forked one.
    """

    rng: np.random.Generator
    fresh: Child
    forked: Child

    def moment(self, number: int) -> tuple[str, Moment]:
        """Return the kind of the moment of a kill, and the moment."""
        if number % FRESH_EACH == FRESH_EACH - 1:
            return FRESH, Moment(self.rng.uniform(0, self.fresh.seconds))
        if number % 2:
            return ANY, Moment(self.rng.uniform(0, self.forked.seconds))
        wait = self.rng.uniform(0, 0.01) if self.rng.random() < 0.5 else 0.0
        return CHANGE, Moment(wait, change=int(self.rng.integers(len(self.forked.changes))) + 1)


def kills_fit(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Kill runs one to four times each until there are so many kills, and end them; yield the counts.

    About half of the kills are at any moment, half at a change of a file of the run or within 10 ms after.

    Args:
        folder: to work in.
        count: of kills.
        seed: of the moments.

    Raises:
        RuntimeError: if runs that are not killed are not alike, so that nothing could be compared.
    """
    rng = np.random.default_rng(seed)
    unbroken, forked = TinyRun(folder, "unbroken"), TinyRun(folder, "forked")
    draw = Draw(rng, unbroken.train(fresh=True), forked.train())
    if troubles := [*trouble(draw.fresh), *trouble(draw.forked), *forked.differences(unbroken)]:
        raise RuntimeError(f"runs that nobody killed: {troubles}")
    ways, places, epochs = Counter[str](), Counter[str](), Counter[int]()
    runs = equal = loaded = 0
    findings: list[str] = []
    while ways.total() < count:
        run = TinyRun(folder, f"run{runs}")
        found: list[str] = []
        for _ in range(min(int(rng.integers(1, 5)), count - ways.total())):
            way, moment = draw.moment(ways.total())
            child = run.train(moment, fresh=way == FRESH)
            if not child.killed:  # the moment would have come after its end
                found += trouble(child)
                break
            ways[way] += 1
            epochs[run.kept] += 1
            loaded += len(run.checkpoints)
            places.update([place(child)] if way == CHANGE else [])
            found += [f"after a kill at {moment}: {words}" for words in run.troubles()]
        found += [*trouble(run.train()), *run.differences(unbroken)]
        findings += [f"{run.name}: {words}" for words in found]
        runs, equal = runs + 1, equal + (not found)
        yield {
            "kills": ways.total(),
            "moments": dict(ways),
            "changes": dict(sorted(places.items())),
            "kills_by_epochs_kept": {str(kept): number for kept, number in sorted(epochs.items())},
            "checkpoints_loaded": loaded,
            "runs": runs,
            "runs_equal_to_the_unbroken_one": equal,
            "findings": findings,
        }


def trouble(child: Child) -> list[str]:
    """Return what is wrong with a child that should have ended by itself."""
    found = [f"it ended with {child.code}: {child.said[-300:]}"] if child.code else []
    return found + ([f"{child.orphans} processes outlived it"] if child.orphans else [])


def place(child: Child) -> str:
    """Return what a child was about to do, or had just begun, when it was killed."""
    event, _, path = child.changes[-1].partition(" ")
    name = "last.ckpt" if "last.ckpt" in path else "best.ckpt" if ".ckpt" in path else "another file"
    return f"{event} {name}"
