"""The tables of a benchmark, as Markdown: mean ± spread over the seeds."""

from collections.abc import Callable, Mapping, Sequence
from math import isnan
from statistics import mean, stdev
from typing import Any

from normalgan.benchmark.measure import OWN
from normalgan.benchmark.plan import Plan
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.training import Result

Results = Mapping[str, Sequence[Result]]
"""The results of each row, a seed each, by the row's name."""

FIGURES = {
    "angular_mean": "mean",
    "angular_median": "median",
    "angular_rmse": "RMSE",
    "below_5": "< 5°",
    "below_7_5": "< 7.5°",
    "below_11_25": "< 11.25°",
    "below_22_5": "< 22.5°",
    "below_30": "< 30°",
    "l1": "L1",
    "l2": "L2",
}
Cell = Callable[[Sequence[Result]], str]


def spread_of(values: Sequence[float], digits: int, unit: str = "") -> str:
    """Return the mean of the values, with the standard deviation of the sample if there are several.

    >>> spread_of([1.0, 2.0, 3.0], 1, "°"), spread_of([0.25], 3), spread_of([float("nan")], 1)
    ('2.0 ± 1.0°', '0.250', '–')
    """
    if not values or any(map(isnan, values)):
        return "–"
    deviation = f" ± {stdev(values):.{digits}f}" if len(values) > 1 else ""
    return f"{mean(values):.{digits}f}{deviation}{unit}"


def large(value: float) -> str:
    """Return a large number with three digits and what they count in.

    >>> [large(v) for v in (0, 950, 54414979, 18.2e9, 2e12)]
    ['–', '950', '54.4 M', '18.2 G', '2.00 T']
    """
    if value == 0:
        return "–"
    for unit, size in (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if value >= size:
            shown = value / size
            return f"{shown:.{2 if shown < 10 else 1 if shown < 100 else 0}f} {unit}"
    return f"{value:.0f}"


def markdown(plan: Plan, scale: Scale, results: Results) -> str:
    """Return all tables of what has been measured so far.

    Args:
        plan: in whose order the rows come.
        scale: at which they were trained.
        results: of the rows; those missing are left out.
    """
    span = f"{scale.seconds:g} seconds a run" if scale.seconds else f"{plan.images} images a generator"
    lines = [f"# {plan.name}, scale {scale.name}", ""]
    learnt = any(run["images"] for runs in results.values() for run in runs)  # a saved model does not tell
    if scale.seconds or learnt:
        lines.append(f"{span[0].upper()}{span[1:]}.")
    if scale.changed:
        lines.append("With " + ", ".join(f"{name}={value}" for name, value in scale.changed.items()) + ".")
    lines += [
        f"Seeds: {_seeds(results)}. Test split, pixels on the object; hinted pixels do not count. What takes "
        "no hints is given none."
    ]
    for title, given in (
        (f"Table 1: {plan.hints} hints, uniform, the same for every method", str(plan.hints)),
        ("Table 1, without hints", "0"),
        ("Table 2: hints of the method's own sampler", OWN),
    ):
        cells = {heading: figure_cell(given, name) for name, heading in FIGURES.items()}
        if given == OWN:
            cells = {"hints": lambda runs: spread_of([r["figures"][OWN]["hints"] for r in runs], 1)} | cells
        lines += ["", f"## {title}", "", *_table(plan, results, cells)]
    by_count = {str(count): figure_cell(str(count), "angular_mean") for count in plan.counts}
    lines += ["", "## Mean angular error by the number of hints", "", *_table(plan, results, by_count)]
    lines += ["", "## What it costs", "", *_table(plan, results, _COSTS)]
    notes = "Speed in float32, in batches, on: " + "; ".join(sorted(_machines(results))) + "."
    return "\n".join([*lines, "", notes]) + "\n"


def figure_cell(given: str, name: str) -> Cell:
    """Return what says a figure of the runs of a row.

    Args:
        given: the hints, ``15`` or ``own``.
        name: of the figure, such as ``angular_mean``: angles in degrees, shares in per cent.
    """

    def cell(runs: Sequence[Result]) -> str:
        values = [_number(run["figures"][given][name]) for run in runs]
        if name.startswith("below"):
            return spread_of([100 * value for value in values], 1, " %")
        return spread_of(values, 2, "°") if name.startswith("angular") else spread_of(values, 3)

    return cell


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _minutes(runs: Sequence[Result]) -> str:
    spent = [run["curve"][-1]["seconds"] / 60 for run in runs if run["curve"]]
    return spread_of(spent, 1)


_COSTS: dict[str, Cell] = {
    "parameters": lambda runs: large(runs[0]["cost"]["parameters"]),
    "FLOPs a map": lambda runs: large(runs[0]["cost"]["flops"]),
    "maps a second": lambda runs: f"{mean(run['cost']['images_per_second'] for run in runs):.1f}",
    "images learnt from": lambda runs: large(mean(run["images"] for run in runs)),
    "minutes of training": _minutes,
}


def _table(plan: Plan, results: Results, cells: Mapping[str, Cell]) -> list[str]:
    lines = [f"| method | {' | '.join(cells)} |", f"| --- |{' ---: |' * len(cells)}"]
    group = None
    for row in plan.rows:
        runs = results.get(row.name)
        if not runs:
            continue
        if row.group != group and row.group:
            lines.append(f"| *{row.group}* |{' |' * len(cells)}")
        group = row.group
        lines.append(f"| {row.label} | {' | '.join(cell(runs) for cell in cells.values())} |")
    return lines


def _seeds(results: Results) -> str:
    seeds: set[Any] = {run["seed"] for runs in results.values() for run in runs} - {None}
    return ", ".join(map(str, sorted(seeds))) or "none"


def _machines(results: Results) -> set[str]:
    machines = [run["machine"] for runs in results.values() for run in runs]
    return {
        m.get("gpu") or f"{m['cores']} cores of {m['processor']}, threads: {m['threads']}" for m in machines
    }
