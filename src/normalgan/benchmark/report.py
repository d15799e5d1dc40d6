"""The report of a benchmark: results.json, table.md and pictures of the results so far."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from normalgan.benchmark.cost import describe_machine, describe_versions
from normalgan.benchmark.curves import draw_calibration, draw_curves
from normalgan.benchmark.evaluation import Evaluation, maps_of
from normalgan.benchmark.hints import hint_points
from normalgan.benchmark.pictures import Line, draw_methods
from normalgan.benchmark.plan import Plan
from normalgan.benchmark.runs import Run
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.table import markdown
from normalgan.benchmark.training import Result, read_result, write_json
from normalgan.callbacks.gallery import batch_row
from normalgan.commit import commit
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.hints import hints_at

__all__ = ["Report"]


@dataclass(frozen=True)
class Report:
    """Writes the results of a plan's runs.

    Args:
        plan: what is compared.
        scale: at which.
        runs: all runs of the plan, finished or not.
        evaluation: how they are measured.
        folder: where the report goes.
    """

    plan: Plan
    scale: Scale
    runs: list[Run]
    evaluation: Evaluation
    folder: Path

    def write(self) -> None:
        """Write all files, each atomically."""
        done = self._done()
        results: dict[str, list[Result]] = {}
        for run, result in done:
            results.setdefault(run.row.name, []).append(result)
        plan, caption = self.plan, f"{self.plan.name}, scale {self.scale.name}"
        device = self.evaluation.device
        head: dict[str, Any] = {
            "plan": plan.name,
            "scale": self.scale.name,
            "changed": self.scale.changed,
            "seconds": self.scale.seconds,
            "images": None if self.scale.seconds else plan.images,
            "specification": self.evaluation.specification,
            "size": self.evaluation.data.recipe.size,
            "seeds": sorted({run.seed for run, _ in done if run.seed is not None}),
            "machine": describe_machine(device),
            "versions": describe_versions(),
            "commit": commit(),
        }
        write_json(self.folder / "results.json", {**head, "runs": [result for _, result in done]})
        write_bytes(
            self.folder / "table.md", markdown(plan, self.scale, results, head["specification"]).encode()
        )
        curves = draw_curves(plan, results, caption)
        if curves:
            write_bytes(self.folder / "curves.png", curves)
        calibration = draw_calibration(plan, results, caption)
        if calibration:
            write_bytes(self.folder / "calibration.png", calibration)
        first: dict[str, Run] = {}
        for run, _ in done:
            first.setdefault(run.row.name, run)
        shown = [first[row.name] for row in plan.rows if row.name in first]
        if shown:
            gallery = draw_methods([self._line(run) for run in shown], caption)
            write_bytes(self.folder / "gallery.png", gallery)

    def _done(self) -> list[tuple[Run, Result]]:
        """Return the runs that have a result of this plan and scale."""
        done = []
        for run in self.runs:
            try:
                result = read_result(run, self.evaluation.hash)
            except InputError:  # damaged; the run reports it in its turn
                continue
            if result:
                done.append((run, {**result, "scale": self.scale.name}))
        return done

    def _line(self, run: Run) -> Line:
        batch, plan = self.evaluation.shown, self.plan
        where = hint_points(batch["mask"], batch["name"], plan.hint_seed, plan.hints)
        hints, preds = hints_at(batch["normal"], where), maps_of(run.folder)
        of_pairs = self.evaluation.data.of_pairs
        rows = [batch_row(batch, i, hints, torch.from_numpy(preds), of_pairs) for i in range(len(preds))]
        return Line(run.row.label, rows)
