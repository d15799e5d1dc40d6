"""Report of a benchmark: write results.json, table.md and pictures of the results so far."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from normalgan.benchmark.cost import describe_origin
from normalgan.benchmark.curves import draw_calibration, draw_curves
from normalgan.benchmark.evaluation import Evaluation, maps_of
from normalgan.benchmark.hints import hint_points
from normalgan.benchmark.pictures import Line, draw_methods
from normalgan.benchmark.runs import Run
from normalgan.benchmark.table import markdown
from normalgan.benchmark.training import Result, read_result, write_json
from normalgan.callbacks.gallery import batch_row
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.hints import hints_at


def write_report(evaluation: Evaluation, runs: Sequence[Run], folder: Path) -> None:
    """Write the results of a plan's runs so far, each file atomically.

    Args:
        evaluation: evaluation that the results belong to.
        runs: all runs of the plan, finished or not.
        folder: output folder.
    """
    plan, scale = evaluation.plan, evaluation.scale
    done = _done(evaluation, runs)
    results: dict[str, list[Result]] = {}
    first: dict[str, Run] = {}
    for run, result in done:
        results.setdefault(run.row.name, []).append(result)
        first.setdefault(run.row.name, run)
    head: dict[str, Any] = {
        "plan": plan.name,
        "scale": scale.name,
        "changed": scale.changed,
        "seconds": scale.seconds,
        "images": None if scale.seconds else plan.images,
        "specification": evaluation.specification,
        "size": evaluation.data.recipe.size,
        "seeds": sorted({run.seed for run, _ in done if run.seed is not None}),
        **describe_origin(evaluation.device),
    }
    write_json(folder / "results.json", {**head, "runs": [result for _, result in done]})
    write_bytes(folder / "table.md", markdown(plan, scale, results, head["specification"]).encode())
    caption = f"{plan.name}, scale {scale.name}"
    lines = [_line(evaluation, first[row.name]) for row in plan.rows if row.name in first]
    pictures = {
        "curves.png": draw_curves(plan, results, caption),
        "calibration.png": draw_calibration(plan, results, caption),
        "gallery.png": draw_methods(lines, caption) if lines else None,
    }
    for name, content in pictures.items():
        if content:
            write_bytes(folder / name, content)


def _done(evaluation: Evaluation, runs: Sequence[Run]) -> list[tuple[Run, Result]]:
    """Return the runs that have a result for this plan and scale."""
    done = []
    for run in runs:
        try:
            result = read_result(run, evaluation.hash)
        except InputError:  # damaged, which is reported when it is the run's turn
            continue
        if result:
            done.append((run, {**result, "scale": evaluation.scale.name}))
    return done


def _line(evaluation: Evaluation, run: Run) -> Line:
    batch, plan = evaluation.shown, evaluation.plan
    where = hint_points(batch["mask"], batch["name"], plan.hint_seed, plan.hints)
    hints, preds = hints_at(batch["normal"], where), torch.from_numpy(maps_of(run.folder))
    of_pairs = evaluation.data.of_pairs
    return Line(run.row.label, [batch_row(batch, i, hints, preds, of_pairs) for i in range(len(preds))])
