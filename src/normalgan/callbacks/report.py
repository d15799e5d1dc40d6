"""TestReport: the table, gallery and metrics of `normalgan test`."""

import hashlib
import json
from math import isnan
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from torch import Tensor

from normalgan.batch import Batch
from normalgan.callbacks.gallery import Row, batch_row, draw_gallery
from normalgan.callbacks.table import results_table
from normalgan.commit import commit
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.loading.order import spread
from normalgan.errors import printable
from normalgan.files.json_files import encode_json
from normalgan.files.writing import write_bytes
from normalgan.gan import NormalGAN
from normalgan.metrics import MapMetric, StageMetrics
from normalgan.metrics.collection import check_names
from normalgan.ranges import PositiveInt, check_ranges
from normalgan.version import __version__


class TestReport(Callback):
    """Measures two baselines that ignore the sketch, prints the table and draws the gallery.

    The baselines put the metrics into perspective. They are the constant normal (0, 0, 1) and the
    per-pixel mean of the training split. ``metrics.json`` and ``gallery.png`` are written to a subfolder
    of the run named after the checkpoint, such as ``test/last``. In ``metrics.json``, ``run`` describes
    the measured model: checkpoint and its SHA-256, seeds, commit, version.

    Attributes:
        checkpoint: the measured file, if it is not the trainer's ``ckpt_path``.

    Args:
        samples: number of gallery rows, spread over the test split.
        metrics: extra metrics for the table.

    Raises:
        InputError: if two metrics have the same name.
    """

    __test__ = False  # otherwise pytest collects a class of this name as a test
    _baselines: StageMetrics
    _further: StageMetrics
    _mean_map: Tensor
    _of_pairs: bool

    def __init__(self, samples: PositiveInt = 6, metrics: list[MapMetric] = []) -> None:  # noqa: B006  # never changed
        check_names(metrics)
        self.samples = samples
        check_ranges(self)
        self.metrics = metrics
        self.checkpoint: Path | None = None
        self._rows: list[Row] = []
        self._shown: set[int] = set()
        self._seen = self._total = 0

    def on_test_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Compute the mean map, and choose the samples to show."""
        data = getattr(trainer, "datamodule", None)
        if not isinstance(data, MeshDataModule):
            raise TypeError("TestReport needs the MeshDataModule, whose training split gives the mean map.")
        self._of_pairs = data.of_pairs
        self._mean_map = data.mean_normal_map().to(pl_module.device)
        baselines = ("constant", "mean_map")
        self._baselines = StageMetrics("test", baselines).to(pl_module.device)
        rows = (*baselines, "hints", "off_hints", "no_hints")
        self._further = StageMetrics("test", rows, self.metrics).to(pl_module.device)
        # limit_test_batches reduces the tested samples; the gallery shows samples of one process only.
        samples, share = len(data.test_dataset), int(trainer.num_test_batches[0]) * data.batch_size
        self._total = min(samples, share * trainer.world_size)
        self._shown = set(spread(min(-(-samples // trainer.world_size), share), self.samples))
        self._rows, self._seen = [], 0

    def on_test_batch_end(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        outputs: dict[str, tuple[Tensor, Tensor]],  # type: ignore[override]  # what NormalGAN.test_step returns
        batch: Batch,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        """Update the metrics of the baselines, and keep gallery rows of the batch."""
        if not isinstance(pl_module, NormalGAN):
            raise TypeError(f"TestReport measures a NormalGAN, not a {type(pl_module).__name__}.")
        target, mask = batch["normal"], batch["mask"]
        facing = torch.tensor([0.0, 0.0, 1.0], device=target.device).view(1, 3, 1, 1)
        baselines = {"constant": facing.expand_as(target), "mean_map": self._mean_map.expand_as(target)}
        for row, preds in baselines.items():
            self._baselines.update(row, preds, target, mask)
        if self.metrics:
            for row, (preds, where) in {**{k: (v, mask) for k, v in baselines.items()}, **outputs}.items():
                self._further.update(row, preds, target, where)
        here = [i for i in range(len(target)) if self._seen + i in self._shown]
        self._seen += len(target)
        if here:
            hints = pl_module.measured_hints(batch)
            preds = outputs["hints"][0]
            self._rows += [batch_row(batch, i, hints, preds, self._of_pairs) for i in here]

    def on_test_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Log the metrics of the baselines next to those of the generator."""
        figures = self._baselines.pop() | self._further.pop()
        pl_module.log_dict(figures, sync_dist=True)  # already reduced, so equal on all processes

    def on_test_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Print the table, and write the metrics and the gallery."""
        if not trainer.is_global_zero:
            return
        results: dict[str, dict[str, float]] = {}
        for key, value in trainer.callback_metrics.items():
            if key.startswith("test/"):
                _, row, figure = key.split("/")
                results.setdefault(row, {})[figure] = float(value)
        measured = self._measured(trainer, pl_module)
        folder = _folder(Path(trainer.default_root_dir) / "test", measured)
        write_bytes(folder / "metrics.json", _json(measured, results))
        write_bytes(folder / "gallery.png", draw_gallery(self._rows))
        count = f"{self._total} sample{'s' if self._total > 1 else ''}"
        print(f"\n{results_table(results, f'Test split, {count}', self.metrics)}\n")
        print(printable(f"Metrics: {(folder / 'metrics.json').resolve()}"))
        print(printable(f"Picture: {(folder / 'gallery.png').resolve()}"))

    def _measured(self, trainer: Trainer, pl_module: LightningModule) -> dict[str, Any]:
        """Return a description of the measured run as plain values for JSON."""
        given = self.checkpoint or trainer.ckpt_path
        path = Path(given) if given is not None and Path(given).is_file() else None
        data = getattr(trainer, "datamodule", None)
        return {
            "checkpoint": None if path is None else path.name,
            "sha256": None if path is None else hashlib.sha256(path.read_bytes()).hexdigest(),
            "seed": {"model": getattr(pl_module, "seed", None), "data": getattr(data, "seed", None)},
            "samples": self._total,
            "commit": commit(),
            "version": __version__,
        }


def _folder(root: Path, measured: dict[str, Any]) -> Path:
    """Return the checkpoint's folder, or a new one if it already holds the metrics of another checkpoint."""
    if measured["checkpoint"] is None:
        return root
    folder = root / Path(measured["checkpoint"]).stem
    try:
        before = json.loads((folder / "metrics.json").read_bytes())["run"]["sha256"]
    except (OSError, ValueError, KeyError, TypeError):
        return folder
    sha256 = measured["sha256"]
    return folder if before == sha256 else folder.with_name(f"{folder.name}-{sha256[:8]}")


def _json(measured: dict[str, Any], results: dict[str, dict[str, float]]) -> bytes:
    """Return the description of the run and the metrics as JSON, with null for nan."""
    figures = {
        row: {name: None if isnan(value) else value for name, value in sorted(values.items())}
        for row, values in sorted(results.items())
    }
    return encode_json({"run": measured, **figures})
