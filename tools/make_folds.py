"""Splits the FourLegs into five folds, each with 4 test meshes, 2 validation meshes and 14 training meshes.

tools/make_folds.py configs/fourleg/folds
"""

import json
import sys
from pathlib import Path

import numpy as np

MESHES = tuple(str(number) for number in range(381, 401))
FOLDS = 5


def folds(seed: int = 0) -> list[dict[str, list[str]]]:
    """Return the splits; the validation meshes are the first two test meshes of the next fold."""
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
