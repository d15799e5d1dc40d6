"""Predictions: a generator's per-pixel output in the form that the losses use."""

from typing import NamedTuple

import torch
from torch import Tensor


class Predictions(NamedTuple):
    """A generator's per-pixel output, in float32 at any precision of the network."""

    direction: Tensor
    """(N, 3, H, W) unit normals; without `presence`, vectors in [-1, 1] that are short outside the object."""
    presence: Tensor | None = None
    """(N, 1, H, W) logit of the object mask; a probability that rounds to 1 would have no gradient."""
    confidence: Tensor | None = None
    """(N, 1, H, W) concentration κ > 0 of the direction."""

    @property
    def normal(self) -> Tensor:
        """Normals (N, 3, H, W) scaled by the presence, as returned by `Generator.forward`."""
        return self.direction if self.presence is None else self.direction * torch.sigmoid(self.presence)

    def of(self, chosen: slice) -> "Predictions":
        """Return the predictions for some of the pictures."""
        direction, presence, confidence = self
        return Predictions(
            direction[chosen],
            None if presence is None else presence[chosen],
            None if confidence is None else confidence[chosen],
        )

    def channels(self) -> Tensor:
        """Return the normals (N, 3, H, W), or (N, 4, H, W) with the confidence if there is one."""
        return self.normal if self.confidence is None else torch.cat([self.normal, self.confidence], dim=1)
