"""Mutants of sound files: made from a seed, and what a reader must do with each."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from limited import SECONDS, Answer
from mutator import mutated
from seeds_of_mutants import lay_out


def lay_out_mutants(folder: Path, kinds: dict[str, bytes], count: int, seed: Sequence[int]) -> list[Path]:
    """Write mutants of each kind in turn; the same seed gives the same bytes.

    Args:
        folder: where to.
        kinds: sound files by name.
        count: of mutants.
        seed: of the choices.
    """
    rng = np.random.default_rng(seed)
    names = list(kinds)
    return [
        lay_out(folder, mutated(kinds[name], rng), name, number)
        for number, name in enumerate(names[i % len(names)] for i in range(count))
    ]


def fault(answer: Answer) -> str | None:
    """Return what is wrong with what a reader made of a mutant, or None if it kept its promise."""
    if answer.outcome not in {"read", "refused"}:
        return answer.words
    if answer.outcome == "refused" and answer.name not in answer.words:
        return f"the sentence does not name the file: {answer.words}"
    if "\n" in answer.words:
        return f"more than a sentence: {answer.words}"
    if answer.seconds >= SECONDS:
        return f"took {answer.seconds:.1f} s"
    return None
