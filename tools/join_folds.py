"""Joins the results of a benchmark's folds: intervals over the test meshes of all of them.

tools/join_folds.py configs/benchmark/fourlegs.yaml runs/fold?/results.json
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from normalgan.benchmark.plan import read_plan
from normalgan.benchmark.table import interval_table
from normalgan.errors import InputError


def join(folds: Sequence[Mapping[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Return for each row that all folds have its runs, a seed each, with the meshes of all folds.

    Raises:
        InputError: if two folds test on the same mesh, or were measured on other views or hints.
    """
    kinds = {json.dumps({k: v for k, v in f["specification"].items() if k != "meshes"}) for f in folds}
    if len(kinds) > 1:
        raise InputError(
            "the folds were measured on other views or hints; only such that were alike are joined."
        )
    joined: dict[tuple[str, Any], dict[str, Any]] = {}
    for fold in folds:
        for run in fold["runs"]:
            one = joined.setdefault(
                (run["row"], run["seed"]), {"seed": run["seed"], "folds": 0, "meshes": {}}
            )
            one["folds"] += 1
            for given, meshes in run["meshes"].items():
                known = one["meshes"].setdefault(given, {})
                twice = known.keys() & meshes.keys()
                if twice:
                    raise InputError(f"two folds test on the mesh {min(twice)}; each mesh is tested on once.")
                known |= meshes
    rows: dict[str, list[dict[str, Any]]] = {}
    for (row, _), run in joined.items():
        if run["folds"] == len(folds):
            rows.setdefault(row, []).append(run)
    return rows


if __name__ == "__main__":
    results = [json.loads(Path(path).read_text(encoding="utf-8")) for path in sys.argv[2:]]
    print("\n".join(interval_table(read_plan(sys.argv[1]), join(results))))
