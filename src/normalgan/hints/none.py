"""NoHints: no hints, only the sketch, as in pix2pix."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.hints.base import HINT_SAMPLERS, HintSampler


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class NoHints(HintSampler):
    """Sample no hints, for pix2pix or other networks without hints.

    References:
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks".
    """

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return zeros (N, 1, H, W); ``rng`` is not used."""
        return torch.zeros_like(normal[:, :1])
