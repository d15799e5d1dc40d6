"""Metrics of the predicted object: IoU with the true mask, and coverage of it."""

import torch
from torch import Tensor

from normalgan.metrics.base import MapMetric

PRESENT = 0.5
"""Predicted vectors longer than this count as object."""


def presence(vectors: Tensor) -> Tensor:
    """Return the object mask (N, 1, H, W), a bool tensor, predicted by vectors (N, 3, H, W)."""
    return vectors.square().sum(1, keepdim=True).sqrt() > PRESENT


class _PresenceMetric(MapMetric):
    """Base class of metrics of the predicted mask, over all pixels; ``mask`` itself is ignored."""

    is_differentiable = False
    higher_is_better = True

    both: Tensor
    total: Tensor

    def __init__(self) -> None:
        super().__init__()
        for name in ("both", "total"):
            self.add_state(name, torch.zeros((), dtype=torch.int64), dist_reduce_fx="sum")

    def compute(self) -> Tensor:
        """Return the fraction, or nan if there was nothing to count."""
        return self.both.float() / self.total


class MaskIoU(_PresenceMetric):
    """Intersection over union of the predicted and the true object mask; 1 is best."""

    label = "mask IoU"

    @property
    def figure(self) -> str:
        """Name of the metric in results."""
        return "mask_iou"

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the state with a batch; the target is zero outside the object, and ``mask`` is ignored.

        Pictures without an object are skipped, because they only pad a process's part of a data set.
        """
        there = presence(target)
        predicted = presence(preds) & there.flatten(1).any(1)[:, None, None, None]
        self.both = self.both + (predicted & there).sum()
        self.total = self.total + (predicted | there).sum()


class Coverage(_PresenceMetric):
    """Fraction of the true object's pixels where an object is predicted."""

    label = "coverage"
    unit = "%"

    @property
    def figure(self) -> str:
        """Name of the metric in results."""
        return "coverage"

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the state with a batch; the target is zero outside the object, and ``mask`` is ignored."""
        there = presence(target)
        self.both = self.both + (presence(preds) & there).sum()
        self.total = self.total + there.sum()
