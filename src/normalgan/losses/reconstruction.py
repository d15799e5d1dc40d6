"""Reconstruction: the base of the generator's per-pixel losses."""

from abc import ABC, abstractmethod
from typing import NamedTuple

from torch import Tensor

from normalgan.models.predictions import Predictions
from normalgan.registry import Registry

__all__ = ["RECONSTRUCTIONS", "Reconstruction", "Term"]


class Term(NamedTuple):
    """A part of a loss."""

    value: Tensor
    """A scalar; logged as it is, as ``train/<name>``."""
    weight: float
    """How much it counts."""


class Reconstruction(ABC):
    """Base of the losses that compare a predicted map with the true one."""

    @abstractmethod
    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return the parts of the loss by name; their weighted sum is minimised.

        Args:
            preds: the predictions of the generator, before the truth is pasted in at hints; float32.
                ``preds.normal`` (N, 3, H, W) every generator has, presence and confidence only some.
            target: (N, 3, H, W) true unit normals, 0 off the object.
            mask: (N, 1, H, W), 1 on the object.
            where: (N, 1, H, W), 1 at the hints.
        """


RECONSTRUCTIONS: Registry[Reconstruction] = Registry(Reconstruction, "normalgan.reconstructions")  # type: ignore[type-abstract]
