"""Relief: how flat predicted normals are compared with true ones, by distance from the contour."""

import math
from abc import abstractmethod
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
import torch
from torch import Tensor

from normalgan.arrays import BoolMask, Floats
from normalgan.metrics.base import FRACTION, MapMetric, fixed_point
from normalgan.metrics.functional import angular_error, unit_vectors
from normalgan.metrics.presence import presence

_SIDE = 170
"""Side of a picture in the unit of distances from the contour."""
_RIM_WIDTH, _DEEP_FROM = 1, 10
"""Limits in these units: the rim is nearer to the contour than the first, the interior farther than the
second."""
_EDGES = (0, 1, 2, 3, 4, 6, 8, 10, 16, 24, math.inf)
"""Edges of the distance bins, in 170ths of the picture's side; the lower edge is inclusive."""

_ALL, _RIM, _DEEP, _BINS = 0, 1, 2, 3
"""The zones of an object; the distance bins come last."""
_PIXELS, _ANGLE, _NZ = 0, 1, 2
"""Names of the values that are summed over each zone."""
_MEANS = {
    "nz_bias": (_ALL, _NZ),
    "nz_bias_rim": (_RIM, _NZ),
    "angular_rim": (_RIM, _ANGLE),
    "angular_deep": (_DEEP, _ANGLE),
}
RELIEF = (*_MEANS, "gradient_ratio")
"""Names of the relief metrics, which benchmarks add."""


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
    """Return the total variation of normals, summed over the pairs of neighbouring pixels, (N,).

    It is lower than the truth for a blurred map and higher for a noisy map.

    Args:
        normals: (N, 3, H, W), which are scaled to unit length first.
        mask: (N, 1, H, W), 1 at counted pixels; pairs with a pixel outside the mask are ignored.

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


def distance_from_contour(mask: Tensor) -> Tensor:
    """Return the distance of each pixel from the contour, in pixels; 0 outside the object.

    The contour runs halfway between object pixels and background pixels, so the outermost object pixels
    have a distance of 0.5. There is no contour where the picture's border cuts the object.

    Args:
        mask: (N, 1, H, W), 1 on the object.

    Returns:
        (N, 1, H, W) in float32, on the CPU; infinite where the object fills the whole picture.

    Example:
        >>> distance_from_contour(torch.tensor([0.0, 1, 1, 1]).view(1, 1, 1, 4))[0, 0, 0].tolist()
        [0.0, 0.5, 1.5, 2.5]
    """
    inside = mask[:, 0].cpu().numpy() > 0.5
    return torch.from_numpy(np.stack([_of_one(one) for one in inside]))[:, None]


def _of_one(inside: BoolMask) -> Floats:
    if inside.all():
        return np.full(inside.shape, np.inf, np.float32)
    distance = cv2.distanceTransform(inside.view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.where(inside, distance - np.float32(0.5), np.float32(0))


class ReliefMetric(MapMetric):
    """Base class of the relief metrics, which share their state: sums over zones of the object.

    The zones are the whole object, the rim (within 1/170 of the picture's side from the contour, at least
    the outermost pixels), the interior (farther than 10/170 from the contour), and the distance bins of
    `_EDGES`.
    """

    is_differentiable = False

    zones: Tensor
    variation: Tensor
    invalid: Tensor

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        shapes = {"zones": (_BINS + len(_EDGES) - 1, 3), "variation": (2,), "invalid": ()}
        for name, shape in shapes.items():
            self.add_state(name, torch.zeros(shape, dtype=torch.int64), dist_reduce_fx="sum")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Update the state with a batch; the target is zero outside the object."""
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
            for low, high in pairwise(_EDGES)
        ]
        sums = torch.stack([fixed_point((values * zone).sum((2, 3)), FRACTION) for zone in zones])
        self.zones = self.zones + sums
        varied = torch.stack([total_variation(normals, inside & finite) for normals in (preds, target)], 1)
        self.variation = self.variation + fixed_point(varied, FRACTION)

    def compute(self) -> Tensor:
        """Return the metric over all batches so far; nan without pixels or for non-finite predictions."""
        return torch.where(self.invalid > 0, torch.nan, self.value())

    @abstractmethod
    def value(self) -> Tensor:
        """Return the metric, given that all predictions are finite."""

    def profile(self) -> list[dict[str, float]]:
        """Return error and n_z bias of each non-empty distance bin, in 170ths of the picture's side."""
        pixels, angle, nz = (self.zones[_BINS:].double() * FRACTION).T.tolist()
        return [
            {
                "from": float(_EDGES[i]),
                "to": float(_EDGES[i + 1]),
                "pixels": int(count),
                "angular_mean": round(angle[i] / count, 4),
                "nz_bias": round(nz[i] / count, 4),
            }
            for i, count in enumerate(pixels)
            if count
        ]


class ZoneMean(ReliefMetric):
    """Mean of a value over a zone.

    Args:
        figure: ``nz_bias``, the mean of predicted minus true n_z (above 0 is too flat); ``nz_bias_rim``,
            the same at the rim; ``angular_rim`` and ``angular_deep``, the mean angular errors at the rim
            and deep inside.
    """

    def __init__(self, figure: str, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._figure = figure

    @property
    def figure(self) -> str:
        """Name of the metric in results."""
        return self._figure

    def value(self) -> Tensor:
        """Return degrees, or a difference of n_z."""
        zone, what = _MEANS[self.figure]
        return self.zones[zone, what].float() / self.zones[zone, _PIXELS]


class GradientRatio(ReliefMetric):
    """Ratio of the total variation of predicted normals to that of true ones; below 1 is too smooth."""

    def value(self) -> Tensor:
        """Return the ratio."""
        return self.variation[0].float() / self.variation[1]


def relief_metrics() -> list[MapMetric]:
    """Return all relief metrics, which can share one state."""
    return [*map(ZoneMean, _MEANS), GradientRatio()]
