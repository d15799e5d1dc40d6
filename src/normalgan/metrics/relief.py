"""Relief: whether normals turn away from the viewer as much as true ones, by distance from the contour."""

import math
from abc import abstractmethod
from itertools import pairwise
from typing import Any

import torch
from torch import Tensor

from normalgan.metrics.base import FRACTION, MapMetric, whole
from normalgan.metrics.contour import distance_from_contour
from normalgan.metrics.functional import angular_error, unit_vectors
from normalgan.metrics.presence import presence

__all__ = [
    "EDGES",
    "RELIEF",
    "GradientRatio",
    "ReliefMetric",
    "ZoneMean",
    "depth_difference",
    "relief_metrics",
    "total_variation",
]

_SIDE = 170
"""The side of a picture in the units in which distances from the contour are given."""
_RIM_WIDTH, _DEEP_FROM = 1, 10
"""In these units: up to the first from the contour is the rim, farther than the second is deep inside."""
EDGES = (0, 1, 2, 3, 4, 6, 8, 10, 16, 24, math.inf)
"""Edges of the bins of distance, in 170ths of the picture; a bin has its lower edge."""

_ALL, _RIM, _DEEP, _BINS = 0, 1, 2, 3
"""The zones of an object; the bins of distance come last."""
_PIXELS, _ANGLE, _NZ = 0, 1, 2
"""The values that are summed over each zone."""
_MEANS = {
    "nz_bias": (_ALL, _NZ),
    "nz_bias_rim": (_RIM, _NZ),
    "angular_rim": (_RIM, _ANGLE),
    "angular_deep": (_DEEP, _ANGLE),
}
RELIEF = (*_MEANS, "gradient_ratio")
"""The names of the figures of relief; benchmarks have them."""


def depth_difference(preds: Tensor, target: Tensor) -> Tensor:
    """Return predicted minus true n_z, (N, 1, H, W); positive where the prediction is too flat.

    Args:
        preds: (N, 3, H, W) predicted normals, of any length.
        target: (N, 3, H, W) true unit normals.

    Example:
        >>> flat, slanted = torch.tensor([0.0, 0.0, 2.0]), torch.tensor([0.6, 0.0, 0.8])
        >>> depth_difference(flat.view(1, 3, 1, 1), slanted.view(1, 3, 1, 1)).item()
        0.19999998807907104
    """
    return unit_vectors(preds)[:, 2:3] - target[:, 2:3]


def total_variation(normals: Tensor, mask: Tensor) -> Tensor:
    """Return how much normals change from pixel to pixel, summed over the pairs of neighbours, (N,).

    A blurred map changes less than the truth, a noisy one more.

    Args:
        normals: (N, 3, H, W), scaled to unit length first.
        mask: (N, 1, H, W), 1 where pixels count; pairs with a pixel off it are left out.

    Example:
        >>> normals = torch.eye(3)[[0, 0, 1]].T.reshape(1, 3, 1, 3)  # right, right, up
        >>> total_variation(normals, torch.ones(1, 1, 1, 3)).item()
        1.4142135381698608
    """
    unit, inside = unit_vectors(normals), mask > 0.5
    sums = unit.new_zeros(len(unit))
    for axis in (2, 3):
        size = normals.shape[axis]
        here, there = (unit.narrow(axis, start, size - 1) for start in (0, 1))
        both = inside.narrow(axis, 0, size - 1) & inside.narrow(axis, 1, size - 1)
        lengths = (there - here).square().sum(1, keepdim=True).sqrt()
        sums = sums + torch.where(both, lengths, torch.zeros_like(lengths)).sum((1, 2, 3))
    return sums


class ReliefMetric(MapMetric):
    """Base of the metrics of relief, which share their counts: sums over zones of the object.

    The zones are all of the object, its rim (the outer 1/170 of the picture along the contour, at least the
    outermost pixels), what is farther than 10/170 from the contour, and the bins of distance of `EDGES`.
    """

    is_differentiable = False

    zones: Tensor
    variation: Tensor
    invalid: Tensor

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        shapes = {"zones": (_BINS + len(EDGES) - 1, 3), "variation": (2,), "invalid": ()}
        for name, shape in shapes.items():
            self.add_state(name, torch.zeros(shape, dtype=torch.int64), dist_reduce_fx="sum")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch; where the target is zero there is no object."""
        inside = mask > 0.5
        values = torch.cat([inside, angular_error(preds, target), depth_difference(preds, target)], dim=1)
        finite = values.isfinite().all(1, keepdim=True)
        self.invalid = self.invalid + (inside & ~finite).sum()
        values = torch.where(inside & finite, values, 0.0)
        distance = distance_from_contour(presence(target)).to(preds.device)
        unit = max(preds.shape[2:]) / _SIDE
        zones = [distance >= 0, distance <= max(_RIM_WIDTH * unit, 0.5), distance > _DEEP_FROM * unit]
        zones += [
            (distance >= low * unit) & ((distance < high * unit) | math.isinf(high))
            for low, high in pairwise(EDGES)
        ]
        sums = torch.stack([whole((values * zone).sum((2, 3)), FRACTION) for zone in zones])
        self.zones = self.zones + sums
        varied = torch.stack([total_variation(normals, inside & finite) for normals in (preds, target)], 1)
        self.variation = self.variation + whole(varied, FRACTION)

    def compute(self) -> Tensor:
        """Return the metric of all batches so far; nan over no pixels, or if predictions were not finite."""
        return torch.where(self.invalid > 0, torch.nan, self.value())

    @abstractmethod
    def value(self) -> Tensor:
        """Return the metric of the finite predictions."""

    def profile(self) -> list[dict[str, float]]:
        """Return error and n_z bias of each bin of distance with a pixel, in 170ths of the picture."""
        pixels, angle, nz = (self.zones[_BINS:].double() * FRACTION).T.tolist()
        return [
            {
                "from": float(EDGES[i]),
                "to": float(EDGES[i + 1]),
                "pixels": int(count),
                "angular_mean": round(angle[i] / count, 4),
                "nz_bias": round(nz[i] / count, 4),
            }
            for i, count in enumerate(pixels)
            if count
        ]


class ZoneMean(ReliefMetric):
    """Mean over a zone.

    Args:
        figure: ``nz_bias``, the mean n_z predicted - true (above 0 is too flat); ``nz_bias_rim``, the same at
            the rim; ``angular_rim`` and ``angular_deep``, the mean errors at the rim and deep inside.
    """

    def __init__(self, figure: str, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._figure = figure

    @property
    def figure(self) -> str:
        """Its name in results."""
        return self._figure

    def value(self) -> Tensor:
        """Return degrees, or a difference of n_z."""
        zone, what = _MEANS[self.figure]
        return self.zones[zone, what].float() / self.zones[zone, _PIXELS]


class GradientRatio(ReliefMetric):
    """Change of predicted normals from pixel to pixel, in proportion to true ones; below 1 is too smooth."""

    def value(self) -> Tensor:
        """Return the ratio."""
        ratio: Tensor = self.variation[0].float() / self.variation[1]
        return ratio


def relief_metrics() -> list[MapMetric]:
    """Return all metrics of relief, which can share one state."""
    return [*map(ZoneMean, _MEANS), GradientRatio()]
