"""Prints the rows of the short tables in the docs from the results of a benchmark.

tools/benchmark_rows.py docs/results/benchmark_64.json
tools/benchmark_rows.py docs/results/ablation_64.json --differences: also each beside the first
tools/benchmark_rows.py docs/results/benchmark_64.json --differences --beside paper: beside that row
tools/benchmark_rows.py docs/results/placement_64.json --placements: the tables of where hints lie
tools/benchmark_rows.py docs/results/ablation_64.json --hints: what hints buy each method
tools/benchmark_rows.py docs/results/users_64.json --hints 15: beside 15 true ones, not beside none
tools/benchmark_rows.py docs/results/folds_64.json --meshes: how the difference from the first row varies
tools/benchmark_rows.py docs/results/critic_64.json --relief: how relief and outline differ from the first's
tools/benchmark_rows.py docs/results/lines_64.json --other docs/results/ablation_64.json: beside another test
"""

import json
from argparse import ArgumentParser
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

from normalgan.benchmark.intervals import Interval, difference_interval, mesh_interval, total_interval
from normalgan.benchmark.measure import OWN
from normalgan.benchmark.table import figure_cell, interval_cell, spread_of
from normalgan.errors import InputError

COLUMNS = (
    *(("0", "angular_mean"), ("15", "angular_mean"), ("50", "angular_mean")),
    *(("15", "angular_median"), ("15", "below_11_25"), (OWN, "angular_mean")),
)
"""Hints given, and the figure: means with none, 15 and 50; median and share below 11.25° with 15; its own."""
RELIEF = ("nz_bias", "gradient_ratio", "mask_iou")
PLACEMENTS, COUNTS = ("uniform", "curvature", "farthest", "worst"), (3, 10, 17, 30, 60)


def rows(results: Mapping[str, Any]) -> list[str]:
    """Return a line of Markdown for each method, in the order of the plan, with the number of its seeds.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    return [_row(runs) for runs in _by_method(results)]


def placements(results: Mapping[str, Any]) -> list[str]:
    """Return lines of Markdown: matrices for each number of hints, then each method beside the first.

    Errors; then their differences from the first method's, and from those of the same networks with uniform
    hints, with intervals over the meshes and the seeds.

    Args:
        results: of configs/benchmark/placement.yaml, as `normalgan benchmark` writes them.
    """
    methods, lines = _by_method(results), []
    for count in COUNTS:
        lines += ["", f"{count} hints, placed:", ""]
        for runs in methods:
            cells = [figure_cell(f"{placement}-{count}", "angular_mean")(runs) for placement in PLACEMENTS]
            lines.append(f"| {runs[0]['label']} | {' | '.join(cells)} |")
        for title, reference, beside in (
            (f"from {methods[0][0]['label']}, placed alike", methods[0], None),
            ("from the same networks, placed uniformly", None, f"uniform-{count}"),
        ):
            lines += ["", f"{count} hints, difference {title}:", ""]
            for runs in methods:
                found = (
                    total_interval(runs, reference or runs, f"{one}-{count}", "angular_mean", beside)
                    for one in PLACEMENTS
                )
                lines.append(f"| {runs[0]['label']} | {' | '.join(interval_cell(f, '+') for f in found)} |")
    return [*lines, *differences(results)]


def differences(results: Mapping[str, Any], beside: str | None = None) -> list[str]:
    """Return lines of Markdown: each method beside another one, with intervals.

    First over the meshes alone, then over the meshes and the seeds.

    Args:
        results: as `normalgan benchmark` writes them.
        beside: name of the row that the others are set beside; None is the first.

    Raises:
        InputError: if there is no such row.
    """
    methods = _by_method(results)
    names = [runs[0]["row"] for runs in methods]
    if beside is not None and beside not in names:
        raise InputError(f"there is no row {beside}; those of the results are {', '.join(names)}.")
    first = methods[names.index(beside) if beside else 0]
    heading = f"difference from {first[0]['label']}: no hints, 15 uniform ones, its own"
    lines = ["", f"Its own hints; {heading}; over the meshes:", ""]
    for runs in methods:
        own = interval_cell(mesh_interval(runs, OWN, "angular_mean"))
        lines.append(f"| {runs[0]['label']} | {own} | {_beside(difference_interval, runs, first)} |")
    lines += ["", f"The same {heading}; over the meshes and the seeds:", ""]
    return lines + [
        f"| {runs[0]['label']} | {_beside(total_interval, runs, first)} |"
        for runs in methods
        if runs is not first
    ]


def relief(results: Mapping[str, Any]) -> list[str]:
    """Return lines of Markdown: each method's relief and mask without hints, less the first one's.

    n_z, the change from pixel to pixel beside the truth's, and the mask's IoU, with intervals over the meshes
    and the seeds.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    first, *others = _by_method(results)
    lines = ["", f"Difference from {first[0]['label']}, no hints: {', '.join(RELIEF)}", ""]
    for runs in others:
        found = (total_interval(runs, first, "0", name) for name in RELIEF)
        cells = ["–" if one is None else "{:+.3f} [{:+.3f}, {:+.3f}]".format(*one) for one in found]
        lines.append(f"| {runs[0]['label']} | {' | '.join(cells)} |")
    return lines


def other_test(results: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """Return lines of Markdown: each method's errors, less those of the same method in another test.

    With none, 15 uniform hints, 50 and its own, with intervals over the meshes and the seeds.

    Args:
        results: as `normalgan benchmark` writes them.
        other: of the same networks and meshes, drawn otherwise.
    """
    there = {runs[0]["row"]: runs for runs in _by_method(other)}
    lines = ["", f"Difference from {other['plan']}: no hints, 15 uniform ones, 50, its own", ""]
    for runs in _by_method(results):
        if runs[0]["row"] in there:
            found = (
                total_interval(runs, there[runs[0]["row"]], given, "angular_mean")
                for given in ("0", "15", "50", OWN)
            )
            lines.append(f"| {runs[0]['label']} | {' | '.join(interval_cell(f, '+') for f in found)} |")
    return lines


def meshes(results: Mapping[str, Any]) -> list[str]:
    """Return lines of Markdown: least and most over the meshes of each method's error less the first one's.

    Without hints and with 15, the mean over the seeds; then how often, of how many meshes times seeds, it is
    ahead of the first.

    Args:
        results: as `normalgan benchmark` writes them.
    """
    first, *others = _by_method(results)
    lines = ["", f"By mesh, less {first[0]['label']}: no hints, ahead, 15 uniform ones, ahead", ""]
    for runs in others:
        cells = []
        for given in ("0", "15"):
            pairs = [(a["meshes"][given], b["meshes"][given]) for a, b in zip(runs, first, strict=True)]
            by_mesh = [
                [a[mesh]["angular_mean"] - b[mesh]["angular_mean"] for a, b in pairs] for mesh in pairs[0][0]
            ]
            means = [fmean(seeds) for seeds in by_mesh]
            every = [each for seeds in by_mesh for each in seeds]
            cells.append(f"{min(means):+.1f} to {max(means):+.1f}°")
            cells.append(f"{sum(each < 0 for each in every)} of {len(every)}")
        lines.append(f"| {runs[0]['label']} | {' | '.join(cells)} |")
    return lines


def hints(results: Mapping[str, Any], beside: str = "0") -> list[str]:
    """Return lines of Markdown: what each way of giving hints changes of each method's error with another.

    Each with the interval over the meshes, and that over the meshes and the seeds.

    Args:
        results: as `normalgan benchmark` writes them.
        beside: the way of giving hints that the others are set beside; none.
    """
    lines: list[str] = []
    for runs in _by_method(results):
        given = [
            one for one in runs[0]["figures"] if one not in (beside, OWN) and one in runs[0].get("meshes", {})
        ]
        known = figure_cell(beside, "angular_mean")(runs)
        lines += ["", f"{runs[0]['label']}, {'none' if beside == '0' else beside}: {known}", ""]
        for one in given:
            both = (f(runs, runs, one, "angular_mean", beside) for f in (difference_interval, total_interval))
            cells = [figure_cell(one, "angular_mean")(runs), *(interval_cell(found, "+") for found in both)]
            lines.append(f"| {one} | {' | '.join(cells)} |")
    return lines


def _beside(interval: Callable[..., Interval | None], runs: Sequence[Any], reference: Sequence[Any]) -> str:
    given = ("0", "15", OWN)
    return " | ".join(interval_cell(interval(runs, reference, one, "angular_mean"), "+") for one in given)


def _by_method(results: Mapping[str, Any]) -> list[list[Any]]:
    """Return the runs of each method, one for each seed, in the order of the plan."""
    by_method: dict[str, list[Any]] = defaultdict(list)
    for run in results["runs"]:
        by_method[run["row"]].append(run)
    return list(by_method.values())


def _row(runs: Sequence[Any]) -> str:
    seeds = sum(run["seed"] is not None for run in runs)
    cells = [figure_cell(given, name)(runs) for given, name in COLUMNS]
    cells.append(spread_of([runs[0]["figures"][OWN]["hints"]], 1))  # of the data, whatever the seed
    return f"| {runs[0]['label']} | {' | '.join(cells)} | {seeds or '–'} |"


def main() -> None:
    """Print what is asked for."""
    parser = ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("results", type=_read, metavar="RESULTS")
    parser.add_argument("--placements", action="store_true", help="in place of the rows: where hints lie")
    parser.add_argument("--differences", action="store_true", help="each beside the first, or --beside")
    parser.add_argument(
        "--beside", metavar="ROW", help="what differences are from; the first row, if not said"
    )
    parser.add_argument("--relief", action="store_true", help="relief and outline beside the first's")
    parser.add_argument("--hints", nargs="?", const="0", metavar="GIVEN", help="what hints buy; beside none")
    parser.add_argument("--meshes", action="store_true", help="how differences from the first vary by mesh")
    parser.add_argument("--other", type=_read, metavar="RESULTS", help="beside the same in another test")
    options = parser.parse_args()
    lines = placements(options.results) if options.placements else rows(options.results)
    lines += differences(options.results, options.beside) if options.differences else []
    lines += relief(options.results) if options.relief else []
    lines += meshes(options.results) if options.meshes else []
    lines += hints(options.results, options.hints) if options.hints else []
    lines += other_test(options.results, options.other) if options.other else []
    print("\n".join(lines))


def _read(path: str) -> Any:
    return json.loads(Path(path).read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
