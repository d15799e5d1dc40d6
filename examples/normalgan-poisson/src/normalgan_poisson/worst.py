"""WorstPicture, a metric for tables: the mean angular error of the worst picture."""

from typing import Any, ClassVar

import torch
from torch import Tensor

from normalgan.metrics import MapMetric, angular_error

__all__ = ["WorstPicture"]


class WorstPicture(MapMetric):
    """The largest mean angular error on the object over all pictures, in degrees.

    A picture without an object does not count; without any picture the value is nan.
    """

    label: ClassVar[str] = "worst picture"
    unit: ClassVar[str] = "°"

    worst: Tensor

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.add_state("worst", torch.tensor(-1.0), dist_reduce_fx="max")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch; see `MapMetric.update`."""
        inside = mask > 0.5
        pixels = inside.sum((1, 2, 3))
        total = torch.where(inside, angular_error(preds, target), 0.0).sum((1, 2, 3))
        means = torch.where(pixels > 0, total / pixels.clamp(min=1), -1.0)
        self.worst = torch.maximum(self.worst, means.max())

    def compute(self) -> Tensor:
        """Return the error of the worst picture so far as a scalar."""
        return torch.where(self.worst < 0, torch.nan, self.worst)
