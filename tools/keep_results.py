"""Writes benchmark results in the small form for docs/results, with several runs in one file.

tools/keep_results.py runs/critic/results.json -o docs/results/critic_64.json
tools/keep_results.py runs/a/results.json runs/b/results.json -o both.json: rows of a plan, trained apart
tools/keep_results.py runs/placement/results.json --by-mesh angular_mean --without distance -o p.json
tools/keep_results.py animals/evaluation.json -o docs/results/shipped_animals.json: of --evaluate

Numbers are rounded to four digits.
"""

import json
from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from normalgan.errors import InputError
from normalgan.files.json_files import encode_json
from normalgan.files.writing import write_bytes

DIGITS = 4
OF_EVALUATION = (
    *("plan", "scale", "size", "model", "specification"),
    *("figures", "cost", "machine", "versions", "commit"),
)
"""The parts of an evaluation that docs/results keeps."""
ALIKE = ("plan", "scale", "images", "specification", "size")
"""What reports must have in common to be merged."""


def keep(
    reports: Sequence[Mapping[str, Any]], by_mesh: Sequence[str] = (), without: Sequence[str] = ()
) -> dict[str, Any]:
    """Return one report of all runs, ordered by row and then by seed.

    Args:
        reports: reports from `normalgan benchmark`.
        by_mesh: the figures by mesh to keep in addition to the number of pixels; if empty, all.
        without: further parts of a run to leave out, such as ``distance``.

    Raises:
        InputError: if the plans, budgets or tests differ, or a run occurs twice.
    """
    first, left_out = reports[0], set(without)
    for name in ALIKE:
        if any(report.get(name) != first.get(name) for report in reports):
            raise InputError(f"the reports differ in {name}; only reports measured alike can be merged.")
    runs: dict[str, dict[Any, dict[str, Any]]] = {}
    for run in (run for report in reports for run in report["runs"]):
        seeds = runs.setdefault(run["row"], {})
        if run["seed"] in seeds:
            raise InputError(f"two reports contain {run['row']} with seed {run['seed']}; leave one out.")
        seeds[run["seed"]] = {name: value for name, value in run.items() if name not in left_out}
        if by_mesh:
            seeds[run["seed"]]["meshes"] = {
                given: {
                    mesh: {name: found[name] for name in (*by_mesh, "pixels")}
                    for mesh, found in meshes.items()
                }
                for given, meshes in run["meshes"].items()
            }
    kept = {name: value for name, value in first.items() if name not in ("runs", "commit", "seeds")}
    every = [run for seeds in runs.values() for _, run in sorted(seeds.items(), key=lambda one: one[0] or 0)]
    named = sorted({run["seed"] for run in every} - {None})
    return {
        **kept,
        "seeds": named,
        "commits": sorted({str(run.get("commit")) for run in every}),
        "runs": every,
    }


def rounded(report: Mapping[str, Any]) -> bytes:
    """Return a report as JSON with rounded numbers."""
    whole = json.loads(json.dumps(report), parse_float=lambda number: round(float(number), DIGITS))
    return encode_json(whole)


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument(
        "--by-mesh", nargs="+", default=(), metavar="FIGURE", help="the only figures to keep by mesh"
    )
    parser.add_argument("--without", nargs="+", default=(), metavar="PART", help="also left out: distance")
    options = parser.parse_args()
    found = [json.loads(path.read_text(encoding="utf-8")) for path in options.results]
    if len(found) == 1 and "runs" not in found[0]:
        kept = {name: found[0][name] for name in OF_EVALUATION}
    else:
        kept = keep(found, options.by_mesh, options.without)
    write_bytes(options.output, rounded(kept))
