"""Flips: a bit of a rendered data set is turned over; rendering again finds it, and mends it to the byte."""

import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from bits import flip
from tiny_sets import TinySet

SHARD = "shards"
WORKERS_EACH = 5
"""Every fifth time two workers render again."""


def flips(folder: Path, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Flip bits of shards and one of each other file, rendering again after each; yield the counts.

    Args:
        folder: to work in.
        count: of flips in shards.
        seed: of their places.

    Raises:
        RuntimeError: if sets that nobody touched are not alike, so that nothing could be compared.
    """
    rng = np.random.default_rng(seed)
    made, untouched = TinySet(folder, "made"), TinySet(folder, "untouched")
    if troubles := [
        *made.render(0).troubles(),
        *untouched.render(0).troubles(),
        *made.differences(untouched),
    ]:
        raise RuntimeError(f"data sets that nobody touched: {troubles}")
    names = [str(path.relative_to(made.cache)) for path in sorted(made.cache.rglob("*")) if path.is_file()]
    shards = [name for name in names if _kind(name) == SHARD]
    others = [name for name in names if name not in shards]
    kinds, mended = Counter[str](), Counter[str]()
    findings: list[str] = []
    places = [shards[int(rng.integers(len(shards)))] for _ in range(count)] + others
    for number, name in enumerate(map(str, rng.permutation(places))):
        bit = flip(made.cache / name, rng)
        child = made.render(2 if number % WORKERS_EACH == WORKERS_EACH - 1 else 0)
        found = [*child.troubles(), *made.differences(untouched)]
        if _kind(name) == SHARD and _named(name) not in " ".join(child.said.split()):
            found.append(f"it did not say which shard is damaged: {child.said[-300:]}")
        kinds[_kind(name)] += 1
        mended[_kind(name)] += not found
        findings += [f"{name}, bit {bit}: {words}" for words in found]
        if found:  # so that one finding does not make others
            shutil.rmtree(made.cache)
            shutil.copytree(untouched.cache, made.cache)
        yield {"flips": kinds.total(), "in": dict(kinds), "mended": dict(mended), "findings": findings}


def _kind(name: str) -> str:
    """Return what a file of a cache is; its shards are ``KEY/samples.zarr/SPLIT/ARRAY/c/NUMBER/…``."""
    parts = Path(name).parts
    known = {"dataset.json": "the manifest", "zarr.json": "descriptions of arrays"}
    return SHARD if "c" in parts else "marks of finished shards" if "done" in parts else known[parts[-1]]


def _named(name: str) -> str:
    parts = Path(name).parts
    return f"shard {parts[5]} of {parts[2]} in"
