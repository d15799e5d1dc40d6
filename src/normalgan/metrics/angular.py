"""Metrics of the angle between the predicted and the true normal."""

from typing import Any

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.metrics.base import BINS_PER_DEGREE, METRICS, NormalMapMetric


@METRICS.register
class MeanAngularError(NormalMapMetric):
    """Mean angle in degrees over all pixels in the masks.

    Example:
        >>> metric = MeanAngularError()
        >>> right, up = torch.eye(3)[0].view(1, 3, 1, 1), torch.eye(3)[1].view(1, 3, 1, 1)
        >>> metric.update(right, up, torch.ones(1, 1, 1, 1))
        >>> metric.update(up, up, torch.ones(1, 1, 1, 1))
        >>> metric.compute()
        tensor(45.)
    """

    higher_is_better = False
    label = "mean angular error"
    unit = "°"

    def value(self) -> Tensor:
        """Return degrees."""
        return self.mean(self.angle_sum)


@METRICS.register
class MeanAngularErrorPerImage(NormalMapMetric):
    """Mean of the images' mean angles in degrees, so small and large objects have equal weight."""

    higher_is_better = False
    label = "mean over images"
    unit = "°"

    def value(self) -> Tensor:
        """Return degrees."""
        return self.mean_image_angle()


@METRICS.register
class RootMeanSquareAngularError(NormalMapMetric):
    """Root of the mean squared angle, in degrees, over all pixels in the masks."""

    higher_is_better = False
    label = "root mean square"
    unit = "°"

    def value(self) -> Tensor:
        """Return degrees."""
        return self.mean_square_angle().sqrt()


@METRICS.register
class MedianAngularError(NormalMapMetric):
    """Median angle in degrees over all pixels in the masks, to within 0.005°.

    It is computed from a histogram, so memory does not grow with the number of pixels. For an even number
    of pixels, it is the mean of the middle two. A perfect map gets 0.005°, the centre of the first bin.
    """

    higher_is_better = False
    label = "median"
    unit = "°"

    def value(self) -> Tensor:
        """Return degrees."""
        ranks = torch.stack([(self.count + 1) // 2, self.count // 2 + 1])
        bins = torch.searchsorted(self.histogram.cumsum(0), ranks)
        return (bins.float().mean() + 0.5) / BINS_PER_DEGREE


@METRICS.register
class ShareBelow(NormalMapMetric):
    """Fraction, 0…1, of the pixels in the masks with an angle strictly below a threshold.

    The usual thresholds are 5, 7.5, 11.25, 22.5 and 30 degrees.

    Args:
        threshold: threshold in degrees, between 0 and 180, with at most two decimals.
    """

    higher_is_better = True
    unit = "%"

    def __init__(self, threshold: float, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        bins = threshold * BINS_PER_DEGREE
        if not 0 < threshold < 180 or abs(bins - round(bins)) > 1e-6:
            raise InputError(
                f"ShareBelow was given threshold={threshold!r}; "
                "use degrees between 0 and 180 with at most two decimals."
            )
        self.threshold = threshold
        self._bins = round(bins)

    @property
    def figure(self) -> str:
        """Name in results, such as ``below_7_5``; names of torch modules must not contain dots."""
        return f"below_{self.threshold:g}".replace(".", "_")

    def value(self) -> Tensor:
        """Return the fraction."""
        return self.histogram[: self._bins].sum().float() / self.count
