"""Wasserstein: the paper's objective, a critic held Lipschitz by clipping its weights."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.objectives.base import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Scores, mean_over_heads


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class Wasserstein(AdversarialObjective):
    """WGAN with weight clipping, as Sketch2Normal trains and the paper follows.

    The paper's last equation would, read as min over G, maximise L1; the signs here are those that agree
    with the code of Su et al.: L_D = E D(fake) - E D(real), L_G = -E D(fake).

    Args:
        weight_clip: after each critic step every parameter, those of norms too, is clipped to ±weight_clip.

    References:
        Arjovsky et al. 2017, "Wasserstein GAN", algorithm 1; He et al. 2021, equation 3.
    """

    weight_clip: float = 0.01

    def __post_init__(self) -> None:
        if self.weight_clip <= 0:
            raise InputError(f"weight_clip must be positive, not {self.weight_clip}.")

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return E D(fake) - E D(real), minus the estimated Wasserstein distance."""
        return mean_over_heads(fake) - mean_over_heads(real)

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return -E D(fake)."""
        return -mean_over_heads(fake)

    @torch.no_grad()
    def after_discriminator_step(self, discriminator: nn.Module) -> None:
        """Clip the weights."""
        for parameter in discriminator.parameters():
            parameter.clamp_(-self.weight_clip, self.weight_clip)
