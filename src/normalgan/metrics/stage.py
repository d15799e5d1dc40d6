"""StageMetrics: all metrics of a stage, such as validation, for each of its rows."""

from collections.abc import Sequence
from typing import cast

import torch
from torch import Tensor, nn
from torchmetrics import MetricCollection

from normalgan.contracts import refused
from normalgan.metrics.base import MapMetric
from normalgan.metrics.collection import normal_map_metrics
from normalgan.metrics.presence import Coverage, MaskIoU


class StageMetrics(nn.Module):
    """The metric collections of one stage, such as validation with and without hints.

    Args:
        stage: first part of each metric's name.
        rows: names of the rows; metrics are named ``<stage>/<row>/<figure>``.
        only: metrics to use instead of the built-in ones; None for the built-in ones.

    Raises:
        InputError: if two of these metrics have the same name.
    """

    def __init__(self, stage: str, rows: Sequence[str], only: Sequence[MapMetric] | None = None) -> None:
        super().__init__()
        more: list[list[MapMetric]] = [[MaskIoU()], [Coverage()]]
        self.stage = stage
        self.rows = nn.ModuleDict(
            {
                row: normal_map_metrics(f"{stage}/{row}/", own=more)
                if only is None
                else MetricCollection(
                    {metric.figure: metric.clone() for metric in only},
                    prefix=f"{stage}/{row}/",
                    compute_groups=False,
                )
                for row in rows
            }
        )

    def higher_is_better(self) -> dict[str, bool | None]:
        """Return whether higher is better, by name of metric; None for one that does not say it."""
        collections = (cast(MetricCollection, row) for row in self.rows.values())
        return {name: each.higher_is_better for one in collections for name, each in one.items()}

    def update(self, row: str, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the metrics of a row with a batch.

        Args:
            row: name of the row.
            preds: (N, 3, H, W) predicted normals, of any length.
            target: (N, 3, H, W) true unit normals.
            mask: (N, 1, H, W), 1 at measured pixels.
        """
        cast(MetricCollection, self.rows[row]).update(preds, target, mask)

    def pop(self) -> dict[str, Tensor]:
        """Return all metrics by name, reduced across processes, and reset them.

        Raises:
            InputError: if a metric returns anything but a single number.
        """
        figures: dict[str, Tensor] = {}
        for row, module in self.rows.items():
            collection = cast(MetricCollection, module)
            found: dict[str, object] = collection.compute()
            for name, computed in found.items():
                value = torch.tensor(computed) if isinstance(computed, float) else computed
                if not isinstance(value, Tensor) or value.numel() != 1:
                    metric = collection[name.removeprefix(f"{self.stage}/{row}/")]
                    raise refused(metric, value, "a metric computes a tensor of one number")
                figures[name] = value
            collection.reset()
        return figures
