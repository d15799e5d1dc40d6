"""Accumulator: compute the figures of a method over the whole split and per mesh."""

import math
from collections.abc import Sequence
from typing import cast

import torch
from torch import Tensor
from torchmetrics import MetricCollection

from normalgan.metrics import MapMetric, NormalMapMetric, angular_error, normal_map_metrics, without_hints
from normalgan.metrics.calibration import Calibration, expected_angle
from normalgan.metrics.presence import Coverage, MaskIoU
from normalgan.metrics.relief import ReliefMetric, relief_metrics

Figure = dict[str, float | None]


class Accumulator:
    """Accumulates figures batch by batch.

    The figures are those of `normal_map_metrics`, `MaskIoU`, `Coverage` and `relief_metrics`, and
    ``calibration_error`` in degrees if the method predicts a confidence.

    Args:
        device: device on which maps are compared.
        more: additional metrics.

    Attributes:
        samples: number of samples so far.
    """

    def __init__(self, device: torch.device, more: Sequence[MapMetric] = ()) -> None:
        own: list[list[MapMetric]] = [[MaskIoU()], [Coverage()], relief_metrics()]
        self._all = normal_map_metrics(own=own, more=more).to(device)
        self._by_mesh: dict[str, MetricCollection] = {}
        self._calibration: Calibration | None = None
        self.samples = 0

    def update(
        self, predicted: Tensor, target: Tensor, mask: Tensor, where: Tensor, names: Sequence[str]
    ) -> None:
        """Add a batch.

        Args:
            predicted: (N, 3 or 4, H, W), normals, whose length is the probability of an object, and
                optionally the confidence.
            target: (N, 3, H, W), true unit normals.
            mask: (N, 1, H, W), 1 on the object.
            where: (N, 1, H, W), 1 at the hints; these pixels are not counted.
            names: names of the samples, ``mesh/view``.
        """
        preds = predicted[:, :3]
        # A vector of any length counts as a direction; the coverage measures where there is none.
        given = ~(preds == 0).all(1, keepdim=True)
        counted = without_hints(mask, where) * given
        meshes = [mesh_of(name) for name in names]
        for mesh in dict.fromkeys(meshes):
            if mesh not in self._by_mesh:
                self._by_mesh[mesh] = self._all.clone()
                self._by_mesh[mesh].reset()
            rows = [i for i, other in enumerate(meshes) if other == mesh]
            self._by_mesh[mesh].update(preds[rows], target[rows], counted[rows])
        self._all.update(preds, target, counted)
        if predicted.shape[1] > 3:
            self._calibration = self._calibration or Calibration()
            expected = expected_angle(predicted[:, 3:4])
            self._calibration.update(expected, angular_error(preds, target), counted)
        self.samples += len(names)

    def figures(self) -> Figure:
        """Return the figures over all samples; None for a figure that is undefined or had non-finite maps."""
        error = {} if self._calibration is None else {"calibration_error": _plain(self._calibration.error())}
        return {**_computed(self._all), **error}

    def by_mesh(self) -> dict[str, Figure]:
        """Return the figures and the number of pixels of each mesh, without the calibration error."""
        return {
            mesh: {**_computed(metrics), "pixels": int(cast(NormalMapMetric, metrics["l1"]).count)}
            for mesh, metrics in self._by_mesh.items()
        }

    def by_distance(self) -> dict[str, list[Figure]]:
        """Return the error and the n_z bias by distance from the contour, in ``170ths`` of the picture."""
        bins = cast(ReliefMetric, self._all["nz_bias"]).profile()
        return {"170ths": [{name: _plain(value) for name, value in one.items()} for one in bins]}

    def calibration(self) -> list[dict[str, float]] | None:
        """Return the calibration curve; None if no confidence was predicted."""
        return None if self._calibration is None else self._calibration.curve()


def mesh_of(name: str) -> str:
    """Return the mesh of a sample.

    >>> mesh_of("animals/horse/12"), mesh_of("horse")
    ('animals/horse', 'horse')
    """
    return name.rpartition("/")[0] or name


def _computed(metrics: MetricCollection) -> Figure:
    return {name: _plain(float(value)) for name, value in sorted(metrics.compute().items())}


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None
