"""Deals the FourLegs out into five folds of 4 meshes to test on, 2 to choose on and 14 to train on.

tools/make_folds.py configs/fourleg/folds
"""

import json
import sys
from pathlib import Path

import numpy as np

MESHES = tuple(str(number) for number in range(381, 401))
FOLDS = 5


def folds(seed: int = 0) -> list[dict[str, list[str]]]:
    """Return the splits; those to choose on are the first two of the next fold's."""
    dealt = np.random.default_rng(seed).permutation(MESHES).reshape(FOLDS, -1).tolist()
    splits = []
    for number, test in enumerate(dealt):
        val = dealt[(number + 1) % FOLDS][:2]
        train = [mesh for mesh in MESHES if mesh not in {*test, *val}]
        splits.append({"train": train, "val": sorted(val), "test": sorted(test)})
    return splits


if __name__ == "__main__":
    for number, split in enumerate(folds()):
        path = Path(sys.argv[1]) / f"{number}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(split, indent=1) + "\n", encoding="utf-8")
