"""Mutations: thousands of mutants for every reader of files, by the machinery of tests/trust."""

import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from limited import MEMORY, SECONDS, Answer, EndedError, read_limited
from mutants import fault, lay_out_mutants
from seeds_of_mutants import sound, sound_checkpoint

AT_ONCE = 100
"""Mutants a process: few enough to be read in the time that a busy machine gives it."""


def mutations(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Have all readers read mutants, and yield the counts after each of them.

    Args:
        folder: for the mutants; those that broke a reader stay in ``broke`` there.
        count: of mutants, at least; every reader gets as many.
        seed: of their changes.
    """
    kinds = {**sound(), "checkpoint": {"small.ckpt": sound_checkpoint()}}
    each = -(-count // len(kinds))
    readers: dict[str, dict[str, Any]] = {}
    findings: list[str] = []
    for number, (reader, files) in enumerate(kinds.items()):
        mutants = folder / reader
        mutants.mkdir(parents=True)
        paths = lay_out_mutants(mutants, files, each, [seed, number])
        answers = [
            answer
            for start in range(0, each, AT_ONCE)
            for answer in _read(reader, paths[start : start + AT_ONCE])
        ]
        broke = [answer for answer in answers if fault(answer)]
        for answer in broke:
            (folder / "broke" / reader).mkdir(parents=True, exist_ok=True)
            shutil.copy(mutants / answer.name, folder / "broke" / reader)
        findings += [f"{reader} {answer.name}: {fault(answer)}" for answer in broke]
        readers[reader] = _count(answers, len(files))
        yield {
            "mutants": sum(row["mutants"] for row in readers.values()),
            "limits": {"seconds": SECONDS, "memory_mb": MEMORY // 10**6},
            "readers": readers,
            "findings": findings,
        }


def _read(reader: str, paths: list[Path]) -> list[Answer]:
    """Return an answer for each file, also where some of them end the process."""
    try:
        return read_limited(reader, paths)
    except EndedError as ended:
        done = len(ended.answers)
        broke = Answer(ended.file.name, "broke", ended.words, 0, 0)
        rest = paths[done + 1 :]
        return [*ended.answers, broke, *(_read(reader, rest) if rest else [])]


def _count(answers: list[Answer], kinds: int) -> dict[str, Any]:
    slowest = max(answers, key=lambda answer: answer.seconds)
    largest = max(answers, key=lambda answer: answer.memory)
    return {
        "kinds": kinds,
        "mutants": len(answers),
        **{outcome: Counter(a.outcome for a in answers)[outcome] for outcome in ("read", "refused", "broke")},
        "slowest_seconds": round(slowest.seconds, 3),
        "slowest": slowest.name,
        "largest_mb": round(largest.memory / 1e6, 1),
        "largest": largest.name,
    }
