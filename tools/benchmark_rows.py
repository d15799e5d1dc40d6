"""Prints the rows of the short tables in the docs from the results of a benchmark.

tools/benchmark_rows.py docs/results/benchmark_64.json
"""

import json
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from normalgan.benchmark.measure import OWN
from normalgan.benchmark.table import figure_cell, spread_of

COLUMNS = (
    *(("0", "angular_mean"), ("15", "angular_mean"), ("50", "angular_mean")),
    *(("15", "angular_median"), ("15", "below_11_25"), (OWN, "angular_mean")),
)
"""Hints given, and the figure: means with none, 15 and 50; median and share below 11.25° with 15; its own."""


def rows(results: Mapping[str, Any]) -> list[str]:
    """Return a line of Markdown for each method, in the order of the plan, with the number of its seeds.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    by_method: dict[str, list[Any]] = defaultdict(list)
    for run in results["runs"]:
        by_method[run["row"]].append(run)
    return [_row(runs) for runs in by_method.values()]


def _row(runs: Sequence[Any]) -> str:
    seeds = sum(run["seed"] is not None for run in runs)
    cells = [figure_cell(given, name)(runs) for given, name in COLUMNS]
    cells.append(spread_of([runs[0]["figures"][OWN]["hints"]], 1))  # of the data, whatever the seed
    return f"| {runs[0]['label']} | {' | '.join(cells)} | {seeds or '–'} |"


if __name__ == "__main__":
    print("\n".join(rows(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))))
