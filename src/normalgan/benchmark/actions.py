"""Actions of normalgan benchmark: compare methods, or measure a model or another program's maps."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from normalgan.benchmark.curves import draw_calibration
from normalgan.benchmark.evaluation import Evaluation
from normalgan.benchmark.methods import Method, saved_method
from normalgan.benchmark.plan import Plan, Row
from normalgan.benchmark.report import write_report
from normalgan.benchmark.runs import plan_runs
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.specification import check_specification
from normalgan.benchmark.submissions import read_submission, write_inputs
from normalgan.benchmark.table import markdown, mesh_table
from normalgan.benchmark.training import fit, read_state, run_all, write_json
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes

_say = partial(print, flush=True)


def compare(plan: Plan, scale: Scale, out: Path, rows: list[str], seeds: list[int]) -> int:
    """Train and measure some rows of a plan, and return the exit code, which is 1 if a run failed.

    Runs and report go to the folder ``out``. The report also includes other rows that have results.
    """
    every = plan_runs(plan, scale, out, sorted({*plan.seeds, *seeds}))
    runs = [r for r in every if r.row.name in rows and (r.seed is None or r.seed in seeds)]
    evaluation = Evaluation(plan, scale)
    for one in every:  # before anything is trained
        try:
            read_state(one, evaluation.hash)
        except InputError as error:
            if one in runs:
                raise
            _say(f"left out of the report: {error}")
    report = partial(write_report, evaluation, every, out)
    failures = run_all(runs, evaluation.hash, fit, evaluation.of_run, report, _say)
    report()
    _say(f"\n{(out / 'table.md').read_text(encoding='utf-8')}")
    _say(f"Report: {out.resolve()}")
    for failure in failures:
        _say(failure)
    return 1 if failures else 0


def evaluate(plan: Plan, scale: Scale, name: str, out: Path | None = None) -> int:
    """Measure a model on the plan's test split, print the tables, and return the exit code.

    ``name`` is a file or ``shipped``. All figures are written to ``evaluation.json`` in the folder ``out``.
    """
    evaluation = Evaluation(plan, scale, test_alone=True)
    method = saved_method(name, evaluation.shared["data"]["size"], evaluation.device)
    _report(evaluation, name, method, out)
    return 0


def score(plan: Plan, scale: Scale, folder: Path, out: Path | None = None) -> int:
    """Measure another program's predictions like `evaluate`; see `read_submission`."""
    submission = read_submission(folder)
    counts = list(submission.counts)
    predicted = replace(plan, hint_counts=counts, hints=max(counts) or plan.hints, pins=0)
    predicted = replace(predicted, placements=[], placement_counts=[], noise_degrees=[], noise_pixels=[])
    evaluation = Evaluation(predicted, scale, test_alone=True)
    _report(evaluation, submission.name, submission.method(), out)
    return 0


def write_test_inputs(plan: Plan, scale: Scale, folder: Path) -> int:
    """Write the sketches and hints of the plan's test split, and return the exit code."""
    for batch in Evaluation(plan, scale, test_alone=True).batches():
        write_inputs(folder, batch, plan.counts, plan.hint_seed)
    _say(f"Sketches and hints: {folder.resolve()}")
    return 0


def check(plan: Plan, scale: Scale, specification: Path) -> None:
    """Check that a plan at a scale uses the data of a frozen specification.

    Raises:
        InputError: if the data differ.
    """
    track = check_specification(Evaluation(plan, scale, test_alone=True).specification, specification)
    _say(f"{specification}: the track {track}" if track else f"{specification}: as it was frozen")


def _report(evaluation: Evaluation, name: str, method: Method, out: Path | None) -> None:
    """Print the tables of a method, and write its figures to a folder if one is given."""
    plan, scale, figures = evaluation.plan, evaluation.scale, evaluation.of_method(method)
    one = replace(plan, rows=[Row("model", name, configs=["–"])], reference=None)
    shown = {"model": [{**figures, "seed": None, "images": 0, "curve": []}]}
    _say(markdown(one, scale, shown, evaluation.specification))
    _say(mesh_table(figures, plan.hints))
    if out is not None:
        head: dict[str, Any] = {"plan": plan.name, "scale": scale.name, "changed": scale.changed}
        head |= {"model": name, "specification": evaluation.specification}
        result = {"model": [{**figures, "seed": None}]}
        calibration = draw_calibration(one, result, f"{plan.name}, {name}")
        if calibration:
            write_bytes(out / "calibration.png", calibration)
        write_json(out / "evaluation.json", {**head, "size": evaluation.data.recipe.size, **figures})
        _say(f"Figures: {(out / 'evaluation.json').resolve()}")
