"""MapMetric, the base class of all metrics, and NormalMapMetric, the shared state of the built-in ones."""

import re
from abc import ABC, abstractmethod
from typing import Any, ClassVar

import torch
from torch import Tensor
from torchmetrics import Metric

from normalgan.errors import InputError
from normalgan.metrics.functional import angular_error, l1_distance, l2_distance, unit_vectors
from normalgan.registry import Registry

BINS_PER_DEGREE = 100

# Sums are integer multiples of these fractions. They are exact, independent of the order and the number of
# processes, safe when Lightning's `bf16-true` casts the module, and work on devices without float64
# (Apple). An int64 is enough for 10^10 pixels even if all are 180° off.
FRACTION = 2.0**-20
_SQUARE_FRACTION = 2.0**-14


def unit_of(figure: str) -> str:
    """Return the unit of a built-in metric: ``°``, ``%`` for a fraction from 0 to 1, or nothing.

    >>> [unit_of(figure) for figure in ("angular_mean", "below_7_5", "coverage", "l1")]
    ['°', '%', '%', '']
    """
    if figure.startswith(("below", "coverage")):
        return "%"
    return "°" if figure.startswith(("angular", "calibration")) else ""


class MapMetric(Metric, ABC):
    """Base class of metrics of normal maps: a torchmetrics `Metric` with one number per data set.

    Add states with ``add_state`` and a reduction, so that several processes compute the same result as
    one; see https://lightning.ai/docs/torchmetrics/stable/pages/implement.html.

    Attributes:
        label: name of the metric in tables; `figure` if empty.
        unit: unit after the number in tables, such as ``°``; ``%`` shows a fraction from 0 to 1.
    """

    full_state_update = False  # updates depend only on their batch, and states can be merged

    # So that torch.jit can script a network that holds a metric.
    __jit_unused_properties__: ClassVar[list[str]] = [*Metric.__jit_unused_properties__, "figure"]

    label: ClassVar[str] = ""
    unit: ClassVar[str] = ""

    @property
    def figure(self) -> str:
        """Name of the metric in results: the class name in snake case, such as ``mean_angular_error``."""
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", type(self).__name__).lower()

    @abstractmethod
    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the state with a batch.

        Args:
            preds: (N, 3, H, W) predicted normals, of any length.
            target: (N, 3, H, W) true unit normals.
            mask: (N, 1, H, W), 1 at measured pixels.
        """

    @abstractmethod
    def compute(self) -> Tensor:
        """Return the metric over all batches so far, a scalar; nan if there were no pixels."""


METRICS: Registry[MapMetric] = Registry(MapMetric, "normalgan.metrics")  # type: ignore[type-abstract]


class NormalMapMetric(MapMetric):
    """Base class of the built-in metrics: errors on the object, pooled over the pixels of all images.

    A metric is nan if there are no pixels, or if a prediction is not finite on the object. Images without
    pixels in the mask are ignored. Predicted vectors are scaled to unit length.
    """

    is_differentiable = False

    count: Tensor
    invalid: Tensor
    angle_sum: Tensor
    angle_square_sum: Tensor
    l1_sum: Tensor
    l2_sum: Tensor
    histogram: Tensor
    image_count: Tensor
    image_angle_sum: Tensor

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        for name in ("count", "invalid", "angle_sum", "angle_square_sum", "l1_sum", "l2_sum"):
            self._add(name, torch.zeros((), dtype=torch.int64))
        self._add("histogram", torch.zeros(180 * BINS_PER_DEGREE, dtype=torch.int64))
        for name in ("image_count", "image_angle_sum"):
            self._add(name, torch.zeros((), dtype=torch.int64))

    def _add(self, name: str, default: Tensor) -> None:
        self.add_state(name, default, dist_reduce_fx="sum")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the state with a batch.

        Args:
            preds: (N, 3, H, W) predicted normals.
            target: (N, 3, H, W) true unit normals.
            mask: (N, 1, H, W), 1 at measured pixels: the object, possibly `without_hints`.

        Raises:
            InputError: if the shapes differ from these.
        """
        angle = angular_error(preds, target)
        if mask.shape != angle.shape:
            raise InputError(
                f"mask has the shape {tuple(mask.shape)}; it must be {tuple(angle.shape)}, as preds."
            )
        preds = unit_vectors(preds)
        l1, l2 = l1_distance(preds, target), l2_distance(preds, target)
        inside = mask > 0.5
        finite = torch.isfinite(angle + l1 + l2)
        valid = inside & finite
        angle, l1, l2 = (torch.where(valid, error, torch.zeros_like(error)) for error in (angle, l1, l2))

        self.count = self.count + inside.sum()
        self.invalid = self.invalid + (inside & ~finite).sum()
        angles, squares = _by_image(angle), _by_image(angle.square())
        self.angle_sum = self.angle_sum + fixed_point(angles, FRACTION)
        self.angle_square_sum = self.angle_square_sum + fixed_point(squares, _SQUARE_FRACTION)
        self.l1_sum = self.l1_sum + fixed_point(_by_image(l1), FRACTION)
        self.l2_sum = self.l2_sum + fixed_point(_by_image(l2), FRACTION)
        bins = len(self.histogram)
        bin_of = (angle[valid] * BINS_PER_DEGREE).long().clamp(max=bins - 1)
        self.histogram = self.histogram + torch.bincount(bin_of, minlength=bins)
        pixels = inside.sum((1, 2, 3))
        self.image_count = self.image_count + (pixels > 0).sum()
        self.image_angle_sum = self.image_angle_sum + fixed_point(angles / pixels.clamp(min=1), FRACTION)

    def compute(self) -> Tensor:
        """Return the metric over all batches so far, a float32 scalar; nan as described for the class."""
        nothing = (self.count == 0) | (self.invalid > 0)
        return torch.where(nothing, torch.nan, self.value())

    @abstractmethod
    def value(self) -> Tensor:
        """Return the metric; there is at least one pixel, and all values are finite."""

    def mean(self, total: Tensor) -> Tensor:
        """Return the mean over pixels for a sum of the state, which is counted in fractions."""
        return total.float() * FRACTION / self.count

    def mean_square_angle(self) -> Tensor:
        """Return the mean squared angle over the pixels, in degrees²."""
        return self.angle_square_sum.float() * _SQUARE_FRACTION / self.count

    def mean_image_angle(self) -> Tensor:
        """Return the mean of the images' mean angles, in degrees."""
        return self.image_angle_sum.float() * FRACTION / self.image_count


def _by_image(errors: Tensor) -> Tensor:
    """Return the sum over each image's pixels, (N,)."""
    return errors.sum((1, 2, 3))


def fixed_point(sums: Tensor, fraction: float) -> Tensor:
    """Return the sum over images, (N, ...), in integer multiples of the fraction; each image is rounded."""
    return (sums / fraction).round().long().sum(0)
