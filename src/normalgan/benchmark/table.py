"""The tables of a benchmark, as Markdown: mean ± spread over the seeds."""

import json
from collections.abc import Callable, Mapping, Sequence
from math import isnan
from statistics import mean, stdev
from typing import Any

from normalgan.benchmark.intervals import Interval, difference_interval, mesh_interval, total_interval
from normalgan.benchmark.measure import OWN, more_metrics
from normalgan.benchmark.plan import Plan
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.training import Result
from normalgan.gan import SHARE

__all__ = [
    "FIGURES",
    "RELIEF",
    "Cell",
    "Results",
    "figure_cell",
    "interval_cell",
    "interval_table",
    "large",
    "markdown",
    "mesh_table",
    "ranked_error",
    "spread_of",
]

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
RELIEF = {
    "nz_bias": "n_z predicted - true",
    "nz_bias_rim": "the same at the rim",
    "angular_rim": "error at the rim",
    "angular_deep": "deep inside",
    "gradient_ratio": "change from pixel to pixel, predicted / true",
    "mask_iou": "mask IoU",
    "calibration_error": "calibration error",
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
    """Return a large number with three digits and a unit prefix.

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


def markdown(
    plan: Plan, scale: Scale, results: Results, specification: Mapping[str, str | int] | None = None
) -> str:
    """Return all tables of what has been measured so far.

    Args:
        plan: in whose order the rows come.
        scale: at which they were trained.
        results: results of the rows; those missing are left out.
        specification: hashes of the test data, printed if given.
    """
    span = f"{scale.seconds:g} seconds a run" if scale.seconds else f"{plan.images} images a generator"
    lines = [f"# {plan.name}, scale {scale.name}", ""]
    learnt = any(run["images"] for runs in results.values() for run in runs)  # a saved model does not tell
    if scale.seconds or learnt:
        lines.append(f"{span[0].upper()}{span[1:]}.")
    if scale.changed:
        lines.append("With " + ", ".join(f"{name}={value}" for name, value in scale.changed.items()) + ".")
    if plan.test_data:
        changed = ", ".join(f"{name}={json.dumps(value)}" for name, value in plan.test_data.items())
        lines.append(f"The test split has other data than the training split: {changed}.")
    lines += [
        f"Seeds: {_seeds(results)}. Test split, pixels on the object; hinted pixels do not count. What takes "
        "no hints is given none."
    ]
    if specification:
        measured = ", ".join(f"{name} {value}" for name, value in specification.items())
        lines.append(f"Measured on (reports with the same are comparable): {measured}.")
    bare, hinted = "0", str(plan.hints)
    for title, given in (
        (f"Table 1: {plan.hints} hints, uniform, the same for every method", hinted),
        ("Table 1, without hints", bare),
        ("Table 2: hints of the method's own sampler", OWN),
    ):
        cells = {heading: figure_cell(given, name) for name, heading in FIGURES.items()}
        cells |= {
            metric.label or metric.figure: figure_cell(given, metric.figure, metric.unit)
            for metric in more_metrics(plan.metrics)
        }
        cells |= {"coverage": figure_cell(given, "coverage", "%"), "mask IoU": figure_cell(given, "mask_iou")}
        if given == OWN:
            cells = {"hints": lambda runs: spread_of([r["figures"][OWN]["hints"] for r in runs], 1)} | cells
        lines += _section(title, _table(plan, results, cells))
    for given in (bare, hinted):
        lines += _ranking(plan, results, given)
    lines += interval_table(plan, results)
    for given in (bare, hinted):
        cells = {heading: figure_cell(given, name) for name, heading in RELIEF.items()}
        title = f"Relief, rim, mask and confidence: {_hints(given)}"
        lines += _section(title, _table(plan, results, cells))
    lines += ["", _RELIEF_NOTES]
    for given in (bare, hinted):
        if bins := _distances(results, given):
            title = f"By distance from the contour in 170ths of the picture: mean error, {_hints(given)}"
            cells = {label: _distance_cell(given, low) for low, label in bins.items()}
            lines += _section(title, _table(plan, results, cells))
    for title, cells in _further(plan, results).items():
        lines += _section(title, _table(plan, results, cells))
    by_count = {str(count): figure_cell(str(count), "angular_mean") for count in plan.counts}
    lines += _section("Mean angular error by the number of hints", _table(plan, results, by_count))
    machines = "Speed in float32, in batches, on: " + "; ".join(sorted(_machines(results))) + "."
    lines += _section("What it costs", _table(plan, results, _COSTS), machines)
    return "\n".join(lines) + "\n"


def _hints(given: str) -> str:
    """Return the hints in words."""
    return {"0": "no hints", OWN: "its own hints"}.get(given, f"{given} hints")


def _section(title: str, table: Sequence[str], notes: str = "") -> list[str]:
    return ["", f"## {title}", "", *table, *(["", notes] if notes else [])]


def ranked_error(error: float, iou: float) -> float:
    """Return the ranking score of a method, in degrees: a pixel missed or wrongly predicted counts 90°.

    Args:
        error: mean angular error on the true object, in degrees.
        iou: intersection over union of the predicted object and the true one.

    >>> ranked_error(20.0, 1.0), ranked_error(20.0, 0.5), ranked_error(20.0, 0.0)
    (20.0, 55.0, 90.0)
    """
    return iou * error + (1 - iou) * 90


def _ranking(plan: Plan, results: Results, given: str) -> list[str]:
    """Return the lines of the ranking with some hints; nothing if no row has its figures."""
    ranked = []
    for row in plan.rows:
        runs = [run["figures"].get(given, {}) for run in results.get(row.name, ())]
        found = [[_number(run.get(name)) for name in ("angular_mean", "mask_iou")] for run in runs]
        scores = [ranked_error(*figures) for figures in found]
        if scores and not any(map(isnan, scores)):
            ranked.append((mean(scores), row, scores))
    if not ranked:
        return []
    table = ["| rank | method | ranked by | error | coverage | mask IoU |"]
    table.append("| ---: | --- | ---: | ---: | ---: | ---: |")
    columns = (("angular_mean", None), ("coverage", "%"), ("mask_iou", None))
    for place, (_, row, scores) in enumerate(sorted(ranked, key=lambda one: one[0]), 1):
        cells = [figure_cell(given, name, unit)(results[row.name]) for name, unit in columns]
        table.append(f"| {place} | {row.label} | {' | '.join([spread_of(scores, 2, '°'), *cells])} |")
    notes = (
        "Ranked by IoU × error + (1 - IoU) × 90°: a pixel of the object that is missed, or of the background "
        "that is predicted as object, counts 90°. The error is of direction, wherever one is given."
    )
    return _section(f"Ranking, {_hints(given)}", table, notes)


def figure_cell(given: str, name: str, unit: str | None = None) -> Cell:
    """Return the function that gives a cell its figure from the runs of a row.

    Args:
        given: the hints, ``15`` or ``own``.
        name: name of the figure, such as ``angular_mean``: angles in degrees, shares in per cent.
        unit: unit of a metric from a plug-in, ``%`` for a share; None derives it from the name.
    """
    if unit is None:
        angle = name.startswith(("angular", "calibration"))
        unit = "%" if name.startswith("below") else "°" if angle else ""

    def cell(runs: Sequence[Result]) -> str:
        values = [_number(run["figures"].get(given, {}).get(name)) for run in runs]
        if unit == "%":
            return spread_of([100 * value for value in values], 1, " %")
        if unit:
            return spread_of(values, 2, unit)
        shown = spread_of(values, 3)
        return f"+{shown}" if name.startswith("nz") and shown[0].isdigit() else shown

    return cell


def mesh_table(result: Result, hints: int) -> str:
    """Return the figures of a result by mesh, as Markdown.

    Args:
        result: result of one run or model.
        hints: those of table 1.
    """
    columns = [("0", name) for name in ("angular_mean", "nz_bias", "angular_rim", "angular_deep", "mask_iou")]
    columns += [(str(hints), name) for name in ("angular_mean", "nz_bias")]
    headings = [f"{FIGURES.get(name) or RELIEF[name]}, {given or 'no'} hints" for given, name in columns]
    lines = [f"| mesh | {' | '.join(headings)} |", f"| --- |{' ---: |' * len(headings)}"]
    for mesh in result["meshes"]["0"]:
        cells = [
            figure_cell(given, name)([{"figures": {given: result["meshes"][given][mesh]}}])
            for given, name in columns
        ]
        lines.append(f"| {mesh} | {' | '.join(cells)} |")
    return "\n".join(["## By mesh", "", *lines]) + "\n"


def interval_cell(interval: Interval | None, sign: str = "") -> str:
    """Return an interval of degrees.

    >>> interval_cell(Interval(16.7, 15.9, 17.4)), interval_cell(Interval(-1.5, -2.0, -1.0), "+")
    ('16.70° [15.90, 17.40]', '-1.50° [-2.00, -1.00]')
    >>> interval_cell(None)
    '–'
    """
    if interval is None:
        return "–"
    value, low, high = (f"{number:{sign}.2f}" for number in interval)
    return f"{value}° [{low}, {high}]"


def _interval_of(given: str) -> Cell:
    return lambda runs: interval_cell(mesh_interval(runs, given, "angular_mean"))


def _difference_of(interval: Callable[..., Interval | None], given: str, reference: Sequence[Result]) -> Cell:
    return lambda runs: interval_cell(interval(runs, reference, given, "angular_mean"), "+")


def interval_table(plan: Plan, results: Results) -> list[str]:
    """Return the lines of table 3: mean errors, and differences from the reference, over the test meshes.

    If a row has two seeds or more, table 4 follows: the differences over the test meshes and the seeds.

    Args:
        plan: plan with the order of the rows.
        results: results of the rows, by mesh too.
    """
    reference = results.get(plan.reference or "", [])
    cells: dict[str, Cell] = {}
    totals: dict[str, Cell] = {}
    for given in ("0", str(plan.hints), OWN):
        heading = _hints(given)
        cells[heading] = _interval_of(given)
        if reference:
            less = f"{heading}, less {plan.row(str(plan.reference)).label}"
            cells[less] = _difference_of(difference_interval, given, reference)
            totals[less] = _difference_of(total_interval, given, reference)
    notes = (
        "Bootstrap over the meshes, all views of one together, of the mean over the seeds; differences are "
        "paired. They are those of the networks that were trained; with few meshes they are too narrow. ± in "
        "the other tables is the spread of the seeds on the same meshes."
    )
    title = "Table 3: mean error with 95 % intervals over the test meshes"
    lines = _section(title, _table(plan, results, cells), notes)
    others = {name: runs for name, runs in results.items() if name != plan.reference}
    if not any(cell(runs) != interval_cell(None) for runs in others.values() for cell in totals.values()):
        return lines
    notes = (
        "Student's t, the variances over meshes and over seeds added; of the seeds that both have. These are "
        "the ones to quote of methods: an interval that covers 0 shows no difference between them."
    )
    title = "Table 4: the same differences with 95 % intervals over the test meshes and the seeds"
    return lines + _section(title, _table(plan, others, totals), notes)


_RELIEF_NOTES = (
    "n_z above 0 is too flat. The rim is the outer 1/170 of the picture along the contour, at least a pixel; "
    "deep inside is farther than 10/170 from it. The calibration error is the mean difference of the error "
    "that the confidence promises from the one observed."
)


def _distances(results: Results, given: str) -> dict[float, str]:
    """Return the bins of distance that any run has pixels in, from the contour inwards."""
    profiles = [run.get("distance", {}).get(given, {}) for runs in results.values() for run in runs]
    found = {one["from"]: one["to"] for profile in profiles for one in profile.get("170ths", ())}
    return {
        low: f"from {low:g}" if found[low] is None else f"{low:g} to {found[low]:g}" for low in sorted(found)
    }


def _distance_cell(given: str, low: float) -> Cell:
    def cell(runs: Sequence[Result]) -> str:
        values = []
        for run in runs:
            profile = run.get("distance", {}).get(given, {}).get("170ths", ())
            values += [_number(one["angular_mean"]) for one in profile if one["from"] == low]
        return spread_of(values, 1, "°") if values else "–"

    return cell


def _further(plan: Plan, results: Results) -> dict[str, dict[str, Cell]]:
    """Return the columns of the tables that only some plans ask for, by their headings."""
    tables: dict[str, dict[str, Cell]] = {}
    for count in plan.placement_counts:
        tables[f"Where hints lie: mean error with {count} hints, placed"] = {
            name: figure_cell(f"{name}-{count}", "angular_mean") for name in plan.placements
        }
    right = str(plan.hints)
    for what, unit, sizes in (
        ("turned", "degrees", plan.noise_degrees),
        ("moved", "pixels", plan.noise_pixels),
    ):
        if sizes:
            tables[f"Hints that are off: mean error with {right} hints {what} by so many {unit}"] = {
                "0": figure_cell(right, "angular_mean"),
                **{f"{size:g}": figure_cell(f"{unit}-{size:g}", "angular_mean") for size in sizes if size},
            }
    for strategy, where in (
        ("worst", "where the error is greatest"),
        ("suggested", "where the studio suggests"),
    ):
        if plan.pins:
            shown = [number for number in (0, 1, 2, 3, 5, 10, 20, 50) if number <= plan.pins]
            tables[f"One pin after the other, {where}: mean error by number of pins"] = {
                str(number): _pin_cell(strategy, number) for number in shown
            }
    if any(SHARE in run["curve"][-1] for runs in results.values() for run in runs if run["curve"]):
        tables["Adversarial gradient beside that of the reconstruction, at the generator's weights"] = {
            "first": _share_cell(0),
            "last": _share_cell(-1),
        }
    return tables


def _pin_cell(strategy: str, number: int) -> Cell:
    def cell(runs: Sequence[Result]) -> str:
        return spread_of([run["pins"][strategy][number] for run in runs if "pins" in run], 2, "°")

    return cell


def _share_cell(index: int) -> Cell:
    def cell(runs: Sequence[Result]) -> str:
        found = [run["curve"][index].get(SHARE) for run in runs if run["curve"]]
        values = [_number(value) for value in found]
        return f"{mean(values):.1e}" if values and not any(map(isnan, values)) else "–"

    return cell


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _minutes(runs: Sequence[Result]) -> str:
    spent = [run["curve"][-1]["seconds"] / 60 for run in runs if run["curve"]]
    return spread_of(spent, 1)


def _speed(a_second: float) -> str:
    return f"{a_second:.1f}" if a_second else "–"  # 0: it was not painted here


_COSTS: dict[str, Cell] = {
    "parameters": lambda runs: large(runs[0]["cost"]["parameters"]),
    "FLOPs a map": lambda runs: large(runs[0]["cost"]["flops"]),
    "maps a second": lambda runs: _speed(mean(run["cost"]["images_per_second"] for run in runs)),
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
