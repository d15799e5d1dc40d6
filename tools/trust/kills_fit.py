"""Kills of training: at most an epoch is lost, every checkpoint loads, and a run ends as if nothing were."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from moments import CHANGE, FRESH, Draw
from nursery import Child
from tiny_runs import TinyRun


def kills_fit(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Kill runs up to six times each until there are so many kills, and end them; yield the counts.

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
    first, second = unbroken.train(fresh=True), forked.train()
    if troubles := [*first.troubles(), *second.troubles(), *forked.differences(unbroken)]:
        raise RuntimeError(f"runs that nobody killed: {troubles}")
    draw = Draw(rng, first.seconds, second.seconds, len(second.changes))
    ways, places, epochs = Counter[str](), Counter[str](), Counter[int]()
    runs = equal = loaded = 0
    findings: list[str] = []
    while ways.total() < count:
        run = TinyRun(folder, f"run{runs}")
        found: list[str] = []
        for _ in range(min(int(rng.integers(1, 7)), count - ways.total())):
            way, moment = draw.moment(ways.total(), run.kept / unbroken.kept)
            child = run.train(moment, fresh=way == FRESH)
            if not child.killed:  # the moment would have come after its end
                break
            ways[way] += 1
            places.update([place(child)] if way == CHANGE else [])
            if troubles := run.troubles():
                found += [f"after a kill at {moment}: {words}" for words in troubles]
                break
            epochs[run.kept] += 1
            loaded += len(run.checkpoints)
        else:
            child = run.train()
        found += [*child.troubles(), *run.differences(unbroken)]
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


def place(child: Child) -> str:
    """Return what a child was about to do, or had just begun, when it was killed."""
    event, _, path = child.changes[-1].partition(" ")
    name = "last.ckpt" if "last.ckpt" in path else "best.ckpt" if ".ckpt" in path else "another file"
    return f"{event} {name}"
