"""Tables of a benchmark in Markdown, with a row per method."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import isnan, nan
from statistics import mean
from typing import Any

from normalgan.benchmark.cells import (
    Cell,
    cost_cells,
    distance_cell,
    figure_cell,
    interval_cell,
    pin_cell,
    share_cell,
    spread_of,
)
from normalgan.benchmark.intervals import Interval, difference_interval, mesh_interval, total_interval
from normalgan.benchmark.measure import OWN, more_metrics
from normalgan.benchmark.plan import Plan
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.training import Result, Results
from normalgan.gan import ADVERSARIAL_SHARE

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
_RELIEF_NOTES = (
    "n_z above 0 is too flat. The rim is the outer 1/170 of the picture along the contour, at least a pixel; "
    "deep inside is farther than 10/170 from it. The calibration error is the mean difference of the error "
    "that the confidence promises from the one observed."
)
_RANKING_NOTES = (
    "Ranked by IoU × error + (1 - IoU) × 90°: a pixel of the object that is missed, or of the background "
    "that is predicted as object, counts 90°. The error is of direction, wherever one is given."
)
_MESHES_NOTES = (
    "Bootstrap over the meshes, all views of one together, of the mean over the seeds; differences are "
    "paired. They are those of the networks that were trained; with few meshes they are too narrow. ± in "
    "the other tables is the spread of the seeds on the same meshes."
)
_SEEDS_NOTES = (
    "Student's t, the variances over meshes and over seeds added; of the seeds that both have. These are "
    "the ones to quote of methods: an interval that covers 0 shows no difference between them."
)

_NO_TOTALS = (
    "The differences to quote, over the test meshes and the seeds, need two test meshes and two seeds of "
    "the reference and of another method."
)
_NO_MESHES = "An interval needs two test meshes."
_PINS_NOTES = (
    "Pixels that have a pin in the end are left out at every number: compare within a row, not with other "
    "tables."
)

_Columns = Mapping[str, Cell]
"""The columns of a table: the function that fills the cells, by heading."""


def markdown(
    plan: Plan, scale: Scale, results: Results, specification: Mapping[str, str | int] | None = None
) -> str:
    """Return all tables of the results so far, preceded by the hashes of the test data if given."""
    bare, hinted = "0", str(plan.hints)
    by_count = {str(count): figure_cell(str(count), "angular_mean") for count in plan.counts}
    sections = [
        _introduction(plan, scale, results, specification),
        _accuracy(plan, results, f"Table 1: {plan.hints} hints, uniform, the same for every method", hinted),
        _accuracy(plan, results, "Table 1, without hints", bare),
        _accuracy(plan, results, "Table 2: hints of the method's own sampler", OWN),
        _ranking(plan, results, bare),
        _ranking(plan, results, hinted),
        interval_table(plan, results),
        _relief(plan, results, bare),
        [*_relief(plan, results, hinted), "", _RELIEF_NOTES],
        _distances(plan, results, bare),
        _distances(plan, results, hinted),
        *(
            _section(title, plan, results, columns, notes)
            for title, columns, notes in _further(plan, results)
        ),
        _section("Mean angular error by the number of hints", plan, results, by_count),
        _section("What it costs", plan, results, cost_cells(), _machines(results)),
    ]
    return "\n".join(line for section in sections for line in section) + "\n"


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]], names: int = 1) -> list[str]:
    r"""Return the lines of a table with right-aligned numbers.

    Args:
        headings: headings of the columns.
        rows: the cells of each row.
        names: number of leading columns that hold text.

    >>> print("\n".join(markdown_table(["mesh", "error"], [["horse", "20.0°"]])))
    | mesh | error |
    | --- | ---: |
    | horse | 20.0° |
    """
    ruler = ["---"] * names + ["---:"] * (len(headings) - names)
    return [f"| {' | '.join(cells)} |" for cells in (headings, ruler, *rows)]


def ranked_error(error: float, iou: float) -> float:
    """Return the ranking score of a method in degrees; missed and falsely predicted pixels count as 90°.

    Args:
        error: mean angular error on the true object, in degrees.
        iou: intersection over union of the predicted and the true object.

    >>> ranked_error(20.0, 1.0), ranked_error(20.0, 0.5), ranked_error(20.0, 0.0)
    (20.0, 55.0, 90.0)
    """
    return iou * error + (1 - iou) * 90


def mesh_table(result: Result, hints: int) -> str:
    """Return the figures of a run or model per mesh, without and with the hints of table 1, as Markdown."""
    columns = [("0", name) for name in ("angular_mean", "nz_bias", "angular_rim", "angular_deep", "mask_iou")]
    columns += [(str(hints), name) for name in ("angular_mean", "nz_bias")]
    headings = [f"{FIGURES.get(name) or RELIEF[name]}, {given or 'no'} hints" for given, name in columns]
    rows = [
        [mesh]
        + [
            figure_cell(given, name)([{"figures": {given: result["meshes"][given][mesh]}}])
            for given, name in columns
        ]
        for mesh in result["meshes"]["0"]
    ]
    return "\n".join(["## By mesh", "", *markdown_table(["mesh", *headings], rows)]) + "\n"


def interval_table(plan: Plan, results: Results) -> list[str]:
    """Return the lines of table 3: mean errors and differences from the reference, over the test meshes.

    If a row has at least two seeds, table 4 follows with the differences over test meshes and seeds;
    otherwise a sentence says what it needs.
    """
    reference = results.get(plan.reference or "", [])
    columns: dict[str, Cell] = {}
    totals: dict[str, Cell] = {}
    for given in ("0", str(plan.hints), OWN):
        columns[_hints(given)] = _interval_of(given)
        if reference:
            less = f"{_hints(given)}, less {plan.row(str(plan.reference)).label}"
            columns[less] = _difference_of(difference_interval, given, reference)
            totals[less] = _difference_of(total_interval, given, reference)
    title = "Table 3: mean error with 95 % intervals over the test meshes"
    notes = _MESHES_NOTES
    if not any(cell(runs) != interval_cell(None) for runs in results.values() for cell in columns.values()):
        notes = _NO_MESHES
    lines = _section(title, plan, results, columns, notes)
    others = {name: runs for name, runs in results.items() if name != plan.reference}
    if any(cell(runs) != interval_cell(None) for runs in others.values() for cell in totals.values()):
        title = "Table 4: the same differences with 95 % intervals over the test meshes and the seeds"
        lines += _section(title, plan, others, totals, _SEEDS_NOTES)
    elif reference and others:
        lines += ["", _NO_TOTALS]
    return lines


def _introduction(
    plan: Plan, scale: Scale, results: Results, specification: Mapping[str, str | int] | None
) -> list[str]:
    lines = [f"# {plan.name}, scale {scale.name}", ""]
    if scale.seconds:
        lines.append(f"{scale.seconds:g} seconds a run.")
    elif any(run["images"] for run in _runs(results)):  # a saved model does not record it
        lines.append(f"{plan.images} image{'s' if plan.images > 1 else ''} a generator.")
    if scale.changed:
        lines.append("With " + ", ".join(f"{name}={value}" for name, value in scale.changed.items()) + ".")
    if plan.test_data:
        changed = ", ".join(f"{name}={json.dumps(value)}" for name, value in plan.test_data.items())
        lines.append(f"The test split has other data than the training split: {changed}.")
    seeds: set[Any] = {run["seed"] for run in _runs(results)} - {None}
    lines.append(
        f"Seeds: {', '.join(map(str, sorted(seeds))) or 'none'}. Test split, pixels on the object; hinted "
        "pixels are left out. A method that cannot use hints gets none."
    )
    if specification:
        measured = ", ".join(f"{name} {value}" for name, value in specification.items())
        lines.append(f"Measured on (reports with the same are comparable): {measured}.")
    return lines


def _accuracy(plan: Plan, results: Results, title: str, given: str) -> list[str]:
    columns: dict[str, Cell] = {}
    if given == OWN:
        columns["hints"] = lambda runs: spread_of([run["figures"][OWN]["hints"] for run in runs], 1)
    columns |= {heading: figure_cell(given, name) for name, heading in FIGURES.items()}
    for metric in more_metrics(plan.metrics):
        columns[metric.label or metric.figure] = figure_cell(given, metric.figure, metric.unit)
    columns |= {"coverage": figure_cell(given, "coverage"), "mask IoU": figure_cell(given, "mask_iou")}
    return _section(title, plan, results, columns)


def _ranking(plan: Plan, results: Results, given: str) -> list[str]:
    """Return the ranking with the given hints; empty if no row has the figures."""
    ranked = []
    for row in plan.rows:
        figures = [run["figures"].get(given, {}) for run in results.get(row.name, ())]
        scores = [ranked_error(_number(f.get("angular_mean")), _number(f.get("mask_iou"))) for f in figures]
        if scores and not any(map(isnan, scores)):
            ranked.append((mean(scores), row, scores))
    if not ranked:
        return []
    rows = [
        [str(place), row.label, spread_of(scores, 2, "°")]
        + [figure_cell(given, name)(results[row.name]) for name in ("angular_mean", "coverage", "mask_iou")]
        for place, (_, row, scores) in enumerate(sorted(ranked, key=lambda one: one[0]), 1)
    ]
    headings = ["rank", "method", "ranked by", "error", "coverage", "mask IoU"]
    table = markdown_table(headings, rows, names=2)
    return ["", f"## Ranking, {_hints(given)}", "", *table, "", _RANKING_NOTES]


def _relief(plan: Plan, results: Results, given: str) -> list[str]:
    columns = {heading: figure_cell(given, name) for name, heading in RELIEF.items()}
    return _section(f"Relief, rim, mask and confidence: {_hints(given)}", plan, results, columns)


def _distances(plan: Plan, results: Results, given: str) -> list[str]:
    """Return the errors by distance from the contour, outermost first; empty if they were not measured."""
    profiles = [run.get("distance", {}).get(given, {}).get("170ths", ()) for run in _runs(results)]
    edges = {one["from"]: one["to"] for profile in profiles for one in profile}
    columns = {
        f"from {low:g}" if high is None else f"{low:g} to {high:g}": distance_cell(given, low)
        for low, high in sorted(edges.items(), key=lambda edge: edge[0])
    }
    title = f"By distance from the contour in 170ths of the picture: mean error, {_hints(given)}"
    return _section(title, plan, results, columns) if columns else []


def _further(plan: Plan, results: Results) -> Iterator[tuple[str, _Columns, str]]:
    """Yield title, columns and notes of the tables that only some plans have."""
    for count in plan.placement_counts:
        yield (
            f"Where hints lie: mean error with {count} hints, placed",
            {name: figure_cell(f"{name}-{count}", "angular_mean") for name in plan.placements},
            "",
        )
    right = str(plan.hints)
    for what, unit, sizes in (
        ("turned", "degrees", plan.noise_degrees),
        ("moved", "pixels", plan.noise_pixels),
    ):
        off = {f"{size:g}": figure_cell(f"{unit}-{size:g}", "angular_mean") for size in sizes if size}
        if sizes:
            yield (
                f"Inaccurate hints: mean error with {right} hints, {what} by this many {unit}",
                {"0": figure_cell(right, "angular_mean"), **off},
                "",
            )
    if plan.pins:
        numbers = [number for number in (0, 1, 2, 3, 5, 10, 20, 50) if number <= plan.pins]
        for strategy, where in (
            ("worst", "where the error is greatest"),
            ("suggested", "where the studio suggests"),
        ):
            yield (
                f"One pin after the other, {where}: mean error by number of pins",
                {str(number): pin_cell(strategy, number) for number in numbers},
                _PINS_NOTES,
            )
    if any(ADVERSARIAL_SHARE in run["curve"][-1] for run in _runs(results) if run["curve"]):
        title = "Adversarial gradient relative to the reconstruction's, at the generator's weights"
        yield title, {"first": share_cell(0), "last": share_cell(-1)}, ""


def _section(title: str, plan: Plan, results: Results, columns: _Columns, notes: str = "") -> list[str]:
    """Return a section with a table that has a row per method, under group headings."""
    rows = []
    group = None
    for row in plan.rows:
        if runs := results.get(row.name):
            if row.group != group and row.group:
                rows.append([f"*{row.group}*", *("" for _ in columns)])
            group = row.group
            rows.append([row.label, *(cell(runs) for cell in columns.values())])
    table = markdown_table(["method", *columns], rows)
    return ["", f"## {title}", "", *table, *(["", notes] if notes else [])]


def _interval_of(given: str) -> Cell:
    return lambda runs: interval_cell(mesh_interval(runs, given, "angular_mean"))


def _difference_of(interval: Callable[..., Interval | None], given: str, reference: Sequence[Result]) -> Cell:
    return lambda runs: interval_cell(interval(runs, reference, given, "angular_mean"), "+")


def _hints(given: str) -> str:
    """Return the hints in words."""
    return {"0": "no hints", OWN: "its own hints"}.get(given, f"{given} hints")


def _number(value: float | None) -> float:
    return nan if value is None else value


def _runs(results: Results) -> Iterator[Result]:
    return (run for runs in results.values() for run in runs)


def _machines(results: Results) -> str:
    """Return the sentence about the machines on which the speed was measured."""
    machines = {
        one.get("gpu") or f"{one['cores']} cores of {one['processor']}, threads: {one['threads']}"
        for one in (run["machine"] for run in _runs(results))
    }
    return "Speed in float32, in batches, on: " + "; ".join(sorted(machines)) + "."
