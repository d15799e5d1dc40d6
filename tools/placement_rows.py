"""Prints the tables of where hints lie, in the docs, from the results of configs/benchmark/placement.yaml.

tools/placement_rows.py docs/results/placement_64.json
"""

import json
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

from normalgan.benchmark.bootstrap import difference_interval, mesh_interval
from normalgan.benchmark.measure import OWN
from normalgan.benchmark.table import figure_cell, interval_cell

PLACEMENTS, COUNTS = ("uniform", "curvature", "farthest", "worst"), (3, 10, 17, 30, 60)
FIGURE = "angular_mean"


def tables(results: dict[str, Any]) -> list[str]:
    """Return lines of Markdown: a matrix for each number of hints, then each method beside the first.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    by_method: dict[str, list[Any]] = defaultdict(list)
    for run in results["runs"]:
        by_method[run["row"]].append(run)
    lines = []
    for count in COUNTS:
        lines += ["", f"{count} hints, placed:", ""]
        for runs in by_method.values():
            cells = [figure_cell(f"{placement}-{count}", FIGURE)(runs) for placement in PLACEMENTS]
            lines.append(f"| {runs[0]['label']} | {' | '.join(cells)} |")
    first = next(iter(by_method.values()))
    lines += ["", f"Difference from {first[0]['label']}: no hints, 15 uniform ones, its own:", ""]
    for runs in by_method.values():
        beside = [
            interval_cell(difference_interval(runs, first, given, FIGURE), "+") for given in ("0", "15", OWN)
        ]
        own = interval_cell(mesh_interval(runs, OWN, FIGURE))
        lines.append(f"| {runs[0]['label']} | {own} | {' | '.join(beside)} |")
    return lines


if __name__ == "__main__":
    print("\n".join(tables(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))))
