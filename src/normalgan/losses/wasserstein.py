"""Wasserstein objectives, with weight clipping (as in the paper) or with a gradient penalty."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.losses.adversarial import (
    ADVERSARIAL_OBJECTIVES,
    AdversarialObjective,
    Critic,
    Scores,
    mean_over_heads,
)
from normalgan.ranges import NonNegative, Positive


class _DistanceObjective(AdversarialObjective):
    """Losses of a critic that estimates the Wasserstein distance."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return E D(fake) - E D(real), the negative of the estimated Wasserstein distance."""
        return mean_over_heads(fake) - mean_over_heads(real)

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return -E D(fake)."""
        return -mean_over_heads(fake)


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class Wasserstein(_DistanceObjective):
    """WGAN with weight clipping, as in Sketch2Normal and the paper.

    Taken literally as a minimum over G, the paper's last equation would maximise L1. The signs here agree
    with the code of Su et al.: L_D = E D(fake) - E D(real), L_G = -E D(fake).

    Args:
        weight_clip: absolute bound to which all parameters, including those of norms, are clipped after
            each critic step.

    References:
        Arjovsky et al. 2017, "Wasserstein GAN", algorithm 1; He et al. 2021, equation 3.
    """

    weight_clip: Positive = 0.01

    @torch.no_grad()
    def after_discriminator_step(self, discriminator: nn.Module) -> None:
        """Clip the weights."""
        for parameter in discriminator.parameters():
            parameter.clamp_(-self.weight_clip, self.weight_clip)


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class WassersteinGradientPenalty(_DistanceObjective):
    """WGAN-GP. The penalty is defined per sample, so the discriminator must not use batch norm.

    Args:
        gradient_penalty: weight of the penalty.

    References:
        Gulrajani et al. 2017, "Improved Training of Wasserstein GANs", algorithm 1.
    """

    gradient_penalty: NonNegative = 10.0

    def check(self, discriminator: nn.Module) -> None:
        """Raise `InputError` if the discriminator uses batch norm."""
        if any(isinstance(module, nn.BatchNorm2d) for module in discriminator.modules()):
            raise InputError(
                "WassersteinGradientPenalty needs a discriminator without batch norm; "
                "give it norm: instance or norm: none."
            )

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        """Return λ E (‖∇D(x)‖₂ - 1)², with x sampled on lines between true and predicted maps."""
        share = torch.rand(len(real), 1, 1, 1, device=real.device, dtype=real.dtype)
        between = (share * real + (1 - share) * fake).requires_grad_()
        # The sum of one score per sample (the mean over its elements and heads) keeps gradients separate.
        score = torch.stack([head.float().flatten(1).mean(1) for head in critic(between)]).mean(0).sum()
        (gradient,) = torch.autograd.grad(score, between, create_graph=True)
        penalty: Tensor = self.gradient_penalty * (gradient.flatten(1).norm(dim=1) - 1).square().mean()
        return penalty
