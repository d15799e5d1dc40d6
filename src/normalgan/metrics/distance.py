"""Metrics of the distance between the predicted and the true normal."""

from torch import Tensor

from normalgan.metrics.base import METRICS, NormalMapMetric


@METRICS.register
class MeanL1(NormalMapMetric):
    """Mean L1 distance Σ|Δ| over the three coordinates in [-1, 1], over all pixels in the masks."""

    higher_is_better = False

    def value(self) -> Tensor:
        """Return the mean distance."""
        return self.mean(self.l1_sum)


@METRICS.register
class MeanL2(NormalMapMetric):
    """Mean L2 distance ‖Δ‖₂ between vectors in [-1, 1], over all pixels in the masks."""

    higher_is_better = False

    def value(self) -> Tensor:
        """Return the mean distance."""
        return self.mean(self.l2_sum)
