"""Predictions: a generator's output for every pixel, as the losses use it."""

from typing import NamedTuple

import torch
from torch import Tensor

__all__ = ["Predictions"]


class Predictions(NamedTuple):
    """A generator's output for every pixel, in float32 at any precision of the network."""

    direction: Tensor
    """(N, 3, H, W) unit normals; without `presence`, in [-1, 1] of any length: short ones mean no object."""
    presence: Tensor | None = None
    """(N, 1, H, W) logit of there being an object: of a probability that rounds to 1 there is no gradient."""
    confidence: Tensor | None = None
    """(N, 1, H, W) concentration κ > 0 of the direction."""

    @property
    def normal(self) -> Tensor:
        """Normals (N, 3, H, W) whose length is the presence, as `Generator.forward` returns them."""
        return self.direction if self.presence is None else self.direction * torch.sigmoid(self.presence)

    def of(self, chosen: slice) -> "Predictions":
        """Return the predictions of some of the pictures."""
        direction, presence, confidence = self
        return Predictions(
            direction[chosen],
            None if presence is None else presence[chosen],
            None if confidence is None else confidence[chosen],
        )

    def channels(self) -> Tensor:
        """Return (N, 3, H, W), the normals, or (N, 4, H, W) with the confidence, if any."""
        return self.normal if self.confidence is None else torch.cat([self.normal, self.confidence], dim=1)
