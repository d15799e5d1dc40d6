"""Prints the rows of the short tables in the docs from the results of a benchmark.

tools/benchmark_rows.py docs/results/benchmark_64.json
"""

import json
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from normalgan.benchmark.table import spread_of

COLUMNS = (
    *(("0", "angular_mean"), ("15", "angular_mean"), ("50", "angular_mean")),
    *(("15", "angular_median"), ("15", "below_11_25")),
)
"""Hints given, and the figure: means with none, 15 and 50; median and share below 11.25° with 15."""


def rows(results: Mapping[str, Any]) -> list[str]:
    """Return a line of Markdown for each method, in the order of the plan, with the number of its seeds.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    by_method: dict[str, list[Any]] = defaultdict(list)
    for run in results["runs"]:
        by_method[run["label"]].append(run)
    return [_row(label, runs) for label, runs in by_method.items()]


def _row(label: str, runs: Sequence[Any]) -> str:
    seeds = sum(run["seed"] is not None for run in runs)
    cells = [_cell([run["figures"][given][name] for run in runs], name) for given, name in COLUMNS]
    return f"| {label} | {' | '.join(cells)} | {seeds or '–'} |"


def _cell(values: Sequence[float], name: str) -> str:
    if name.startswith("below"):
        return spread_of([100 * value for value in values], 1, " %")
    return spread_of(values, 2, "°")


if __name__ == "__main__":
    print("\n".join(rows(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))))
