"""Metrics of the distance between the predicted and the true normal."""

from torch import Tensor

from normalgan.metrics.base import METRICS, NormalMapMetric

__all__ = ["MeanL1", "MeanL2"]


@METRICS.register
class MeanL1(NormalMapMetric):
    """Mean over all pixels in the masks of Σ|Δ| over the three coordinates, on [-1, 1]."""

    higher_is_better = False

    def value(self) -> Tensor:
        """Return the mean distance."""
        return self.mean(self.l1_sum)


@METRICS.register
class MeanL2(NormalMapMetric):
    """Mean over all pixels in the masks of the length ‖Δ‖₂ of the difference, on [-1, 1]."""

    higher_is_better = False

    def value(self) -> Tensor:
        """Return the mean distance."""
        return self.mean(self.l2_sum)
