"""Evaluation: measure a trained run, or any other model, on the test split that all rows share."""

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import torch
from lightning.fabric.utilities import move_data_to_device

from normalgan.arrays import Floats
from normalgan.batch import Batch
from normalgan.benchmark.cost import describe_origin, flops, images_per_second
from normalgan.benchmark.hints import hint_points, placements
from normalgan.benchmark.measure import HintTests, measure, more_metrics, true_float32
from normalgan.benchmark.methods import Method, constant_method, inflation_method, mean_method, weights_method
from normalgan.benchmark.pins import STRATEGIES, Strategy, pin_curve, pin_one_by_one
from normalgan.benchmark.plan import Plan, Settings
from normalgan.benchmark.runs import Run, build_data, shared_settings
from normalgan.benchmark.scale import Scale
from normalgan.benchmark.settings import digest
from normalgan.benchmark.specification import Specification, specify
from normalgan.benchmark.training import Result, measured_checkpoint
from normalgan.callbacks.display import count_parameters
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.items import collate_decoded, decode
from normalgan.data.loading.order import spread
from normalgan.files.writing import write_bytes
from normalgan.gan import ADVERSARIAL_SHARE
from normalgan.hints import hints_at
from normalgan.weights.checkpoint import read_checkpoint

_BATCH = 16  # the same for all methods, because noise at test time depends on it
_VERSION = 3  # increase it when the figures in results change, so that models are measured again


@dataclass(frozen=True)
class Evaluation:
    """Measures methods on one test split with the same hints.

    Args:
        plan: the benchmark plan.
        scale: scale of the pictures and networks.
        test_alone: whether only the test split is rendered, because nothing is trained.
    """

    plan: Plan
    scale: Scale
    test_alone: bool = False

    @property
    def hash(self) -> str:
        """A hash of everything except the data that determines the figures of a given model."""
        plan = self.plan
        return digest(
            {"counts": plan.counts, "seed": plan.hint_seed, "which": plan.checkpoint}
            | {"placements": plan.placements, "at": plan.placement_counts, "pins": plan.pins}
            | {"degrees": plan.noise_degrees, "pixels": plan.noise_pixels}
            | ({"metrics": plan.metrics} if plan.metrics else {})
            | ({"test_data": plan.test_data} if plan.test_data else {})
            | {"shown": plan.gallery, "hints": plan.hints, "batch": _BATCH, "version": _VERSION}
        )

    @cached_property
    def shared(self) -> Settings:
        """The settings of the data that all rows share and of the device for measuring."""
        return shared_settings(self.plan, self.scale)

    @cached_property
    def device(self) -> torch.device:
        """The device for measuring: a GPU if the scale allows it and one is available."""
        allowed = self.shared["trainer"]["accelerator"] in {"auto", "gpu", "cuda"}
        return torch.device("cuda" if allowed and torch.cuda.is_available() else "cpu")

    @cached_property
    def data(self) -> MeshDataModule:
        """The shared data, with the test split in the plan's style; rendered if necessary."""
        untaught = all(row.classical in {"constant", "inflation"} for row in self.plan.rows)
        alone = self.test_alone or bool(self.plan.test_data) or untaught
        once = {"on_the_fly": False} if alone else {}
        data = build_data(self.shared, batch_size=_BATCH, workers=0, **once, **self.plan.test_data)
        if alone:
            data.sources = {"test": data.sources["test"]}
        data.render(thorough=False)
        return data

    @cached_property
    def shown(self) -> Batch:
        """The samples of the gallery, spread over the test split."""
        samples = self.data.test_dataset
        return collate_decoded([samples[i] for i in spread(len(samples), self.plan.gallery)])

    def of_run(self, run: Run) -> Result:
        """Return the result of a trained run, and save its maps of the gallery's samples in its folder."""
        result: Result = {"row": run.row.name, "label": run.row.label, "group": run.row.group}
        result |= {"seed": run.seed, "images": 0, "checkpoint": None, "curve": []}
        if run.row.classical:
            method = self._classical(run.row.classical)
        else:
            checkpoint = measured_checkpoint(run, self.plan.checkpoint)
            weights = read_checkpoint(checkpoint).weights(self.data.recipe.size)
            method = weights_method(weights, self.device)
            curve = read_curve(run.folder)
            result |= {"checkpoint": checkpoint.name, "curve": curve, "images": curve[-1]["images"]}
        maps = BytesIO()
        np.savez_compressed(maps, preds=self.predict_shown(method).astype(np.float16))
        write_bytes(run.folder / "maps.npz", maps.getbuffer())
        return {**result, **self.of_method(method)}

    def of_method(self, method: Method) -> dict[str, Any]:
        """Return the figures and the cost of a method, and the machine."""
        plan, device = self.plan, self.device
        measured = asdict(measure(method, self.batches(), self.tests, device))
        if plan.pins and method.takes_hints:
            measured["pins"] = {strategy: self._pins(method, strategy) for strategy in STRATEGIES}
        network, size = method.generator, self.data.recipe.size
        cost = {
            "parameters": count_parameters(network) if network else 0,
            "flops": flops(network, size, device) if network else 0,
            "images_per_second": images_per_second(method, next(self.batches()), device)
            if method.timed
            else 0,
        }
        return {**measured, "cost": cost, **describe_origin(device)}

    @property
    def tests(self) -> HintTests:
        """The hints with which every method is tested."""
        plan = self.plan
        placed = placements(plan.placements, plan.placement_counts)
        return HintTests(
            plan.counts, plan.hint_seed, placed, plan.noise, plan.hints, more_metrics(plan.metrics)
        )

    def _pins(self, method: Method, strategy: Strategy) -> list[float]:
        """Return the mean errors after 0, 1, … pins placed by a simulated user."""
        with true_float32():
            batches = (move_data_to_device(batch, self.device) for batch in self.batches())
            return pin_curve([pin_one_by_one(method, one, strategy, self.plan.pins) for one in batches])

    @cached_property
    def specification(self) -> Specification:
        """The specification of the test data."""
        shared, other = {"batch_size": _BATCH, "workers": 0}, self.plan.test_data
        trained = build_data(self.shared, **shared)
        return specify(build_data(self.shared, **shared, **other) if other else trained, self.tests, trained)

    def predict_shown(self, method: Method) -> Floats:
        """Return a method's predictions (K, 3, H, W) for the gallery's samples with the hints of table 1."""
        batch: Batch = move_data_to_device(self.shown, self.device)
        hints = None
        if method.takes_hints:
            where = hint_points(batch["mask"], batch["name"], self.plan.hint_seed, self.plan.hints)
            hints = hints_at(batch["normal"], where)
        return method.predict(batch, hints)[:, :3].cpu().numpy()

    def batches(self) -> Iterator[Batch]:
        """Yield the test split in order."""
        yield from map(decode, self.data.test_dataloader())

    def _classical(self, kind: str) -> Method:
        match kind:
            case "constant":
                return constant_method()
            case "mean":
                # A separate data module, so that the training split does not stay in memory.
                data = build_data(self.shared, batch_size=_BATCH)
                data.render(thorough=False)
                return mean_method(data.mean_normal_map())
            case _:
                return inflation_method()


def read_curve(folder: Path, most: int = 60) -> list[dict[str, float | None]]:
    """Return the learning curve of a run, thinned to ``most`` records with the figures that are drawn."""
    records = json.loads((folder / "curve.json").read_text(encoding="utf-8"))
    kept = ["images", "epoch", "seconds", "val/hints/angular_mean", "val/no_hints/angular_mean"]
    kept += [ADVERSARIAL_SHARE] if all(ADVERSARIAL_SHARE in record for record in records) else []
    return [{name: records[i][name] for name in kept} for i in spread(len(records), most)]


def maps_of(folder: Path) -> Floats:
    """Return a run's saved predictions (K, 3, H, W) for the gallery's samples."""
    with np.load(folder / "maps.npz") as file:
        return np.asarray(file["preds"], np.float32)
