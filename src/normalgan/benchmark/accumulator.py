"""Accumulator: the figures of a method, over the whole split, by mesh and by view."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torchmetrics import MetricCollection

from normalgan.arrays import BoolMask, Doubles
from normalgan.metrics import MapMetric, angular_error, normal_map_metrics, without_hints
from normalgan.metrics.calibration import Calibration, expected_angle
from normalgan.metrics.presence import Coverage, MaskIoU
from normalgan.metrics.relief import depth_difference, total_variation

__all__ = ["DEEP", "EDGES", "PICTURE", "RIM", "Accumulator", "Figure", "Sums", "mesh_of"]

PICTURE = 170
"""The side of a picture in the units in which distances from the contour are given."""
RIM, DEEP = 1, 10
"""In these units: up to the first from the contour is the rim, farther than the second is deep inside."""
EDGES = (0, 1, 2, 3, 4, 6, 8, 10, 16, 24, math.inf)
"""Edges of the bins of distance, in 170ths of the picture; a bin has its lower edge."""

_LAST = len(EDGES) - 2  # number of the last bin

Figure = dict[str, float | None]
Sums = dict[str, Doubles]


class Accumulator:
    """Collects predictions batch by batch, and returns the figures.

    Besides those of `normal_map_metrics`, `MaskIoU` and `Coverage`: ``nz_bias``, mean n_z predicted - true
    (above 0 is too flat); ``gradient_ratio``, how much the predicted normals change from pixel to pixel in
    proportion to the true ones (below 1 is too smooth); ``angular_rim`` and ``angular_deep``, mean errors in
    the outer 1/170 of the picture along the contour and farther than 10/170 from it; ``nz_bias_rim``;
    ``calibration_error`` in degrees, if there is a confidence. The rim has at least the outermost pixels,
    also where they are wider than that.

    Args:
        device: where maps are compared.
        more: additional metrics.

    Attributes:
        names: names of the samples so far.
    """

    def __init__(self, device: torch.device, more: Sequence[MapMetric] = ()) -> None:
        self._device = device
        self._more = more
        self._all = self._metrics()
        self._by_mesh: dict[str, MetricCollection] = {}
        self._calibration: Calibration | None = None
        self.names: list[str] = []
        self._sums: dict[str, list[Doubles]] = {}

    def update(
        self,
        predicted: Tensor,
        target: Tensor,
        mask: Tensor,
        where: Tensor,
        distance: Tensor,
        names: Sequence[str],
    ) -> None:
        """Count a batch.

        Args:
            predicted: (N, 3 or 4, H, W) normals, whose length is the probability of an object, and optionally
                confidence.
            target: (N, 3, H, W) true unit normals.
            mask: (N, 1, H, W), 1 on the object.
            where: (N, 1, H, W), 1 at the hints, which do not count.
            distance: (N, 1, H, W) pixels from the contour.
            names: names of the samples, ``mesh/view``.
        """
        preds = predicted[:, :3]
        # A direction of any length counts; the coverage tells where there is none.
        given = ~(preds == 0).all(1, keepdim=True)
        counted = without_hints(mask, where) * given
        self._all.update(preds, target, counted)
        meshes = [mesh_of(name) for name in names]
        for mesh in dict.fromkeys(meshes):
            rows = [i for i, other in enumerate(meshes) if other == mesh]
            metrics = self._by_mesh.setdefault(mesh, self._metrics())
            metrics.update(preds[rows], target[rows], counted[rows])
        angle = angular_error(preds, target)
        if predicted.shape[1] > 3:
            self._calibration = self._calibration or Calibration()
            self._calibration.update(expected_angle(predicted[:, 3:4]), angle, counted)
        self.names += names
        for name, sums in _view_sums(preds, target, counted, angle, distance).items():
            self._sums.setdefault(name, []).append(sums)

    def figures(self) -> Figure:
        """Return the figures over all samples; None where it is undefined or a map was not finite."""
        error = {} if self._calibration is None else {"calibration_error": _plain(self._calibration.error())}
        return {**self._of(self._all, np.arange(len(self.names))), **error}

    def by_mesh(self) -> dict[str, Figure]:
        """Return the figures of each mesh, without the calibration error."""
        meshes = np.array([mesh_of(name) for name in self.names])
        return {
            mesh: {
                **self._of(metrics, np.flatnonzero(meshes == mesh)),
                "pixels": self._pixels(meshes == mesh),
            }
            for mesh, metrics in self._by_mesh.items()
        }

    def by_view(self) -> dict[str, list[Any]]:
        """Return lists with an entry for each view: pixels that count, mean error and n_z bias."""
        sums = self._joined()
        return {
            "pixels": [int(count) for count in sums["pixels"]],
            "angular_mean": [_rounded(v) for v in _divided(sums["angle"], sums["pixels"])],
            "nz_bias": [_rounded(v) for v in _divided(sums["nz"], sums["pixels"])],
        }

    def by_distance(self) -> dict[str, list[Figure]]:
        """Return error and n_z bias in bins of distance from the contour, in ``170ths`` of the picture."""
        return {"170ths": _profile(self._joined())}

    def calibration(self) -> list[dict[str, float]] | None:
        """Return the calibration curve; None if no confidence was predicted."""
        return None if self._calibration is None else self._calibration.curve()

    def _metrics(self) -> MetricCollection:
        return normal_map_metrics(own=[MaskIoU(), Coverage()], more=self._more).to(self._device)

    def _joined(self) -> Sums:
        return {name: np.concatenate(parts) for name, parts in self._sums.items()}

    def _pixels(self, chosen: BoolMask) -> int:
        return int(self._joined()["pixels"][chosen].sum())

    def _of(self, metrics: MetricCollection, views: NDArray[np.intp]) -> Figure:
        total = {name: sums[views].sum(0) for name, sums in self._joined().items()}
        figures = {
            "nz_bias": _ratio(total["nz"], total["pixels"]),
            "nz_bias_rim": _ratio(total["rim_nz"], total["rim_pixels"]),
            "angular_rim": _ratio(total["rim_angle"], total["rim_pixels"]),
            "angular_deep": _ratio(total["deep_angle"], total["deep_pixels"]),
            "gradient_ratio": _ratio(total["variation"], total["true_variation"]),
        }
        known = {name: float(value) for name, value in metrics.compute().items()}
        return {name: _plain(value) for name, value in sorted({**known, **figures}.items())}


def mesh_of(name: str) -> str:
    """Return the mesh of a sample.

    >>> mesh_of("animals/horse/12"), mesh_of("horse")
    ('animals/horse', 'horse')
    """
    return name.rpartition("/")[0] or name


def _view_sums(preds: Tensor, target: Tensor, counted: Tensor, angle: Tensor, distance: Tensor) -> Sums:
    """Return sums over the pixels of each view, (N,), and over those of each bin of distance, (N, bins)."""
    inside, nz = counted > 0.5, depth_difference(preds, target)
    of_all = {
        "pixels": inside.double(),
        "angle": torch.where(inside, angle, 0.0).double(),
        "nz": torch.where(inside, nz, 0.0).double(),
    }
    unit = max(preds.shape[2:]) / PICTURE
    near = distance.to(preds.device)
    parts = {"rim": near <= max(RIM * unit, 0.5), "deep": near > DEEP * unit}
    sums = {name: values.sum((1, 2, 3)) for name, values in of_all.items()}
    for part, chosen in parts.items():
        sums |= {f"{part}_{name}": (values * chosen).sum((1, 2, 3)) for name, values in of_all.items()}
    sums["variation"] = total_variation(preds, counted)
    sums["true_variation"] = total_variation(target, counted)
    plain = {name: values.double().cpu().numpy() for name, values in sums.items()}
    values = {name: summed.cpu().numpy() for name, summed in of_all.items()}
    bins = np.minimum(np.searchsorted(EDGES, distance.numpy() / unit, side="right") - 1, _LAST)
    for name, of_name in values.items():
        views = zip(bins, of_name, strict=True)
        plain[f"{name}_by_distance"] = np.stack(
            [np.bincount(bin_of.ravel(), one.ravel(), _LAST + 1) for bin_of, one in views]
        )
    return plain


def _profile(sums: Sums) -> list[Figure]:
    count, angle, nz = (sums[f"{name}_by_distance"].sum(0) for name in ("pixels", "angle", "nz"))
    return [
        {
            "from": float(EDGES[i]),
            "to": _plain(float(EDGES[i + 1])),
            "pixels": int(count[i]),
            "angular_mean": _rounded(angle[i] / count[i]),
            "nz_bias": _rounded(nz[i] / count[i]),
        }
        for i in range(_LAST + 1)
        if count[i]
    ]


def _divided(sums: Doubles, counts: Doubles) -> Doubles:
    return np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)


def _ratio(sums: Doubles, counts: Doubles) -> float:
    return float(sums / counts) if counts > 0 else math.nan


def _rounded(value: float) -> float | None:
    return round(float(value), 4) if math.isfinite(value) else None


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None
