"""Determinism: runs with the same seed, each in a process of its own, end in the same bytes of weights."""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tiny_runs import TinyRun, load


def determinism(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Train with one seed as often as asked for, then once with the next seed; yield the digests.

    Args:
        folder: to work in.
        count: of runs with the same seed, two or more.
        seed: of all that is drawn: the weights at first, hints, order, augmentation.
    """
    digests: list[str] = []
    findings: list[str] = []
    for number in range(max(count, 2) + 1):
        other = number == max(count, 2)
        run = TinyRun(folder, f"run{number}", seed + other)
        findings += run.train(fresh=True).troubles()
        digests.append(digest(run.checkpoints["last.ckpt"]))
        if other and digests[-1] == digests[0]:
            findings.append("another seed ends in the same weights")
        if not other and digests[-1] != digests[0]:
            findings.append(f"run {number} ends in other weights than the first")
        yield {"runs": number + 1, "sha256_of_the_weights": digests, "findings": findings}


def digest(checkpoint: Path) -> str:
    """Return the SHA-256 of all weights and running statistics in a checkpoint, names and bytes in order."""
    found = hashlib.sha256()
    for name, weights in load(checkpoint)["state_dict"].items():
        found.update(name.encode())
        found.update(weights.numpy().tobytes())
    return found.hexdigest()
