"""TestReport: the table, the gallery and the figures that `normalgan test` ends with."""

import json
from pathlib import Path

import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from rich.console import Console
from rich.table import Table
from torch import Tensor
from torchmetrics import MetricCollection

from normalgan.batch import Batch
from normalgan.callbacks.rows import batch_row, spread
from normalgan.data.datamodule import MeshDataModule
from normalgan.gallery import Row, write_gallery
from normalgan.gan import NormalGAN
from normalgan.metrics import normal_map_metrics
from normalgan.normals import write_bytes

LABELS = {
    "constant": "constant normal, facing the viewer",
    "mean_map": "mean map of the training split",
    "no_hints": "no hints",
    "hints": "hints of the sampler",
    "unhinted": "… hinted pixels left out",
}
COLUMNS = {
    "angular_mean": "mean °",
    "angular_median": "median °",
    "angular_rmse": "RMSE °",
    "below_5": "< 5°",
    "below_7_5": "< 7.5°",
    "below_11_25": "< 11.25°",
    "below_22_5": "< 22.5°",
    "below_30": "< 30°",
    "l1": "L1",
    "l2": "L2",
    "angular_mean_per_image": "mean ° per image",
}


def results_table(results: dict[str, dict[str, float]], title: str) -> Table:
    """Return the table of results, a row each, for the terminal."""
    table = Table(title=title, title_justify="left")
    table.add_column("on the object")
    for heading in COLUMNS.values():
        table.add_column(heading, justify="right")
    for key, label in LABELS.items():
        if key in results:
            shares = [f"{v:.1%}" if k.startswith("below") else f"{v:.3f}" for k, v in ordered(results[key])]
            table.add_row(label, *shares)
    return table


def ordered(result: dict[str, float]) -> list[tuple[str, float]]:
    """Return the figures of one row in the order of the columns."""
    return [(key, result[key]) for key in COLUMNS]


class TestReport(Callback):
    """Measures two baselines that see no sketch beside the generator; prints the table, draws the gallery.

    The baselines are always in the table, because they show what a figure is worth: the constant normal
    (0, 0, 1) and, pixel by pixel, the mean of the training split. Writes ``test/metrics.json`` and
    ``test/gallery.png`` in the folder of the run.

    Args:
        samples: rows of the gallery, spread over the test split.
    """

    __test__ = False  # pytest takes a class of this name for a test otherwise

    def __init__(self, samples: int = 6) -> None:
        self.samples = samples
        self._rows: list[Row] = []
        self._baselines: dict[str, MetricCollection] = {}
        self._mean_map: Tensor | None = None
        self._seen = 0
        self._wanted: list[int] = []

    def on_test_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Work out the mean map, and which samples to show."""
        data = getattr(trainer, "datamodule", None)
        if not isinstance(data, MeshDataModule):
            raise TypeError("TestReport needs the MeshDataModule, whose training split gives the mean map.")
        self._mean_map = data.mean_normal_map().to(pl_module.device)
        self._baselines = {
            name: normal_map_metrics(f"test/{name}/").to(pl_module.device)
            for name in ("constant", "mean_map")
        }
        self._rows, self._seen = [], 0
        self._wanted = spread(len(data.test_dataset), self.samples)

    def on_test_batch_end(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        outputs: object,
        batch: Batch,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        """Measure the baselines on the batch, and keep the rows that are wanted."""
        if not isinstance(pl_module, NormalGAN) or self._mean_map is None:
            raise TypeError(f"TestReport measures a NormalGAN, not a {type(pl_module).__name__}.")
        target = batch["normal"]
        facing = torch.tensor([0.0, 0.0, 1.0], device=target.device).view(1, 3, 1, 1).expand_as(target)
        self._baselines["constant"].update(facing, target, batch["mask"])
        self._baselines["mean_map"].update(self._mean_map.expand_as(target), target, batch["mask"])
        here = [i - self._seen for i in self._wanted if self._seen <= i < self._seen + len(target)]
        self._seen += len(target)
        if here:
            hints = pl_module.test_hints(batch, batch_idx)
            preds = pl_module(batch["sketch"], hints)
            self._rows += [batch_row(batch, i, hints, preds) for i in here]

    def on_test_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Log the baselines beside the generator."""
        for collection in self._baselines.values():
            pl_module.log_dict(collection.compute())

    def on_test_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Print the table; write the figures and the gallery."""
        if not trainer.is_global_zero:
            return
        results: dict[str, dict[str, float]] = {}
        for key, value in trainer.callback_metrics.items():
            stage, row, figure = key.split("/") if key.count("/") == 2 else ("", "", "")
            if stage == "test":
                results.setdefault(row, {})[figure] = float(value)
        folder = Path(trainer.default_root_dir) / "test"
        write_bytes(folder / "metrics.json", (json.dumps(results, indent=1) + "\n").encode())
        write_gallery(folder / "gallery.png", self._rows)
        Console().print(results_table(results, f"Test split, {self._seen} samples"))
        print(f"Metrics: {(folder / 'metrics.json').resolve()}")
        print(f"Picture: {(folder / 'gallery.png').resolve()}")
