"""A metric: a torchmetrics Metric that takes maps, truth and mask."""

import torch
from torch import Tensor

from normalgan.metrics import METRICS, MapMetric, angular_error
from normalgan.testing import check


@METRICS.register
class WorstError(MapMetric):
    """The largest angular error on the object."""

    label = "worst error"
    unit = "°"

    def __init__(self) -> None:
        super().__init__()
        self.add_state("worst", torch.tensor(0.0), dist_reduce_fx="max")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = torch.maximum(self.worst, (angular_error(preds, target) * mask).max())

    def compute(self) -> Tensor:
        """Return degrees."""
        return self.worst


if __name__ == "__main__":
    check(WorstError())
