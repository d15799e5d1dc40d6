"""Joins the results of a benchmark's folds: figures and intervals over the test meshes of all folds.

tools/join_folds.py configs/benchmark/fourlegs.yaml runs/fold?/results.json
tools/join_folds.py configs/benchmark/fourlegs.yaml runs/fold?/results.json -o docs/results/folds_64.json
"""

import json
from argparse import ArgumentParser
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

from keep_results import rounded

from normalgan.benchmark.measure import OWN
from normalgan.benchmark.plan import read_plan
from normalgan.benchmark.table import interval_table
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes

POOLED = ("angular_mean", "below_11_25", "below_22_5", "below_30")
"""Figures that are means over pixels, so that those of several meshes can be pooled."""


def join(folds: Sequence[Mapping[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Return for each row common to all folds its runs, one per seed, with the meshes of all folds.

    Raises:
        InputError: if two folds test on the same mesh, or were measured on different views or hints.
    """
    kinds = {json.dumps({k: v for k, v in f["specification"].items() if k != "meshes"}) for f in folds}
    if len(kinds) > 1:
        raise InputError(
            "the folds were measured on different views or hints; only folds measured alike can be joined."
        )
    joined: dict[tuple[str, Any], dict[str, Any]] = {}
    for fold in folds:
        for run in fold["runs"]:
            one = joined.setdefault(
                (run["row"], run["seed"]),
                {
                    **{name: run.get(name) for name in ("row", "label", "group", "seed", "images")},
                    "folds": 0,
                    "hints": [],
                    "meshes": {},
                },
            )
            one["folds"] += 1
            one["hints"].append(run["figures"][OWN]["hints"])
            for given, meshes in run["meshes"].items():
                known = one["meshes"].setdefault(given, {})
                twice = known.keys() & meshes.keys()
                if twice:
                    raise InputError(f"two folds test on the mesh {min(twice)}; only one fold may.")
                known |= meshes
    rows: dict[str, list[dict[str, Any]]] = {}
    for (row, _), run in joined.items():
        if run["folds"] == len(folds):
            run["figures"] = {given: _pooled(meshes.values()) for given, meshes in run["meshes"].items()}
            run["figures"][OWN]["hints"] = fmean(run.pop("hints"))  # all folds have the same number of views
            rows.setdefault(row, []).append(run)
    return rows


def _pooled(meshes: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Return the figures pooled over the pixels of all meshes."""
    found = list(meshes)
    total = sum(mesh["pixels"] for mesh in found)
    return {
        name: sum(mesh[name] * mesh["pixels"] for mesh in found) / total
        for name in POOLED
        if all(mesh.get(name) is not None for mesh in found)
    }


def report(folds: Sequence[Mapping[str, Any]], rows: Mapping[str, Sequence[Mapping[str, Any]]]) -> bytes:
    """Return the joined runs as JSON, in the form in which `normalgan benchmark` writes one split."""
    one = folds[0]
    kept = {name: one.get(name) for name in ("plan", "scale", "images", "size", "machine", "versions")}
    commits = sorted({str(run.get("commit")) for fold in folds for run in fold["runs"]})
    specification = {
        **{name: value for name, value in one["specification"].items() if name != "meshes"},
        "meshes": [fold["specification"]["meshes"] for fold in folds],
    }
    runs = [run for runs in rows.values() for run in runs]
    whole = {**kept, "folds": len(folds), "specification": specification, "commits": commits, "runs": runs}
    return rounded(whole)


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("plan")
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="all figures, as JSON")
    options = parser.parse_args()
    found = [json.loads(path.read_text(encoding="utf-8")) for path in options.results]
    together = join(found)
    print("\n".join(interval_table(read_plan(options.plan), together)).lstrip())
    if options.output:
        write_bytes(options.output, report(found, together))
