"""Kills of rendering: run again, it leaves the same bytes as if nobody had killed it, and nothing else."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from moments import FRESH, Draw
from tiny_sets import TinySet

WORKERS = (0, 2)


def kills_render(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Kill renderings up to six times each until there are so many kills, and end them; yield the counts.

    Each is begun, and taken up again, with two workers or with none, by chance. The process that a user
    starts is killed; its workers must end by themselves.

    Args:
        folder: to work in.
        count: of kills.
        seed: of the moments.

    Raises:
        RuntimeError: if sets that nobody disturbed are not alike, so that nothing could be compared.
    """
    rng = np.random.default_rng(seed)
    unbroken = TinySet(folder, "unbroken")
    fresh = unbroken.render(0, fresh=True)
    draws: dict[int, Draw] = {}
    troubles = fresh.troubles()
    for workers in WORKERS:
        whole = TinySet(folder, f"whole{workers}")
        child = whole.render(workers)
        troubles += [*child.troubles(), *whole.differences(unbroken)]
        files = whole.files if workers else 0
        draws[workers] = Draw(rng, fresh.seconds, child.seconds, len(child.changes), files)
    if troubles:
        raise RuntimeError(f"renderings that nobody killed: {troubles}")
    ways, workers_killed, shards = Counter[str](), Counter[str](), Counter[int]()
    sets = equal = left = 0
    findings: list[str] = []
    while ways.total() < count:
        made = TinySet(folder, f"set{sets}")
        found: list[str] = []
        for _ in range(min(int(rng.integers(1, 7)), count - ways.total())):
            workers = int(rng.choice(WORKERS))
            way, moment = draws[workers].moment(ways.total(), made.files / unbroken.files)
            before = made.finished()
            child = made.render(workers, moment, fresh=way == FRESH)
            found += [f"after a kill at {moment}: {words}" for words in _lost(before, made.finished())]
            if not child.killed:  # the moment would have come after its end
                break
            found += [f"{child.orphans} workers outlived a kill at {moment}"] if child.orphans else []
            ways[way] += 1
            workers_killed[f"{workers} workers"] += 1
            shards[len(made.finished())] += 1
            left += len(made.left())
        else:
            before = made.finished()
            child = made.render(int(rng.choice(WORKERS)))
            found += _lost(before, made.finished())
        found += [*child.troubles(), *made.differences(unbroken)]
        findings += [f"{made.name}: {words}" for words in found]
        sets, equal = sets + 1, equal + (not found)
        yield {
            "kills": ways.total(),
            "moments": dict(ways),
            "with": dict(sorted(workers_killed.items())),
            "kills_by_shards_finished": {str(done): number for done, number in sorted(shards.items())},
            "half_written_files_swept": left,
            "data_sets": sets,
            "data_sets_equal_to_the_unbroken_one": equal,
            "findings": findings,
        }


def _lost(before: dict[str, int], after: dict[str, int]) -> list[str]:
    """Return the shards that were finished and have been rendered again."""
    return [f"{name} was finished, and made again" for name in before if after.get(name) != before[name]]
