"""Reconstruction: base class of the generator's per-pixel losses."""

from abc import ABC, abstractmethod
from typing import NamedTuple

from torch import Tensor

from normalgan.models.predictions import Predictions
from normalgan.ranges import RangeChecked
from normalgan.registry import Registry


class Term(NamedTuple):
    """A weighted term of a loss."""

    value: Tensor
    """The unweighted scalar, logged as ``train/<name>``."""
    weight: float
    """Weight of the term in the loss."""


class Reconstruction(RangeChecked, ABC):
    """Base class of losses that compare a predicted map with the true map."""

    @abstractmethod
    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return the terms of the loss by name; their weighted sum is minimised.

        Args:
            preds: float32 predictions of the generator, before the true normals are pasted in at the
                hints. All generators return ``preds.normal`` (N, 3, H, W); only some return presence and
                confidence.
            target: (N, 3, H, W) true unit normals, 0 outside the object.
            mask: (N, 1, H, W), 1 on the object.
            where: (N, 1, H, W), 1 at the hints.
        """


RECONSTRUCTIONS: Registry[Reconstruction] = Registry(Reconstruction, "normalgan.reconstructions")  # type: ignore[type-abstract]
