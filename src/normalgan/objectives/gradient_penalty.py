"""WassersteinGradientPenalty: a critic held Lipschitz by a penalty on its gradient."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.objectives.base import (
    ADVERSARIAL_OBJECTIVES,
    AdversarialObjective,
    Critic,
    Scores,
    mean_over_heads,
)


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class WassersteinGradientPenalty(AdversarialObjective):
    """WGAN-GP. The penalty speaks of single inputs, so the discriminator must not use batch norm.

    Args:
        gradient_penalty: weight of the penalty.

    References:
        Gulrajani et al. 2017, "Improved Training of Wasserstein GANs", algorithm 1.
    """

    gradient_penalty: float = 10.0

    def __post_init__(self) -> None:
        if self.gradient_penalty < 0:
            raise InputError(f"gradient_penalty must be 0 or more, not {self.gradient_penalty}.")

    def check(self, discriminator: nn.Module) -> None:
        """Raise `InputError` if the discriminator uses batch norm."""
        if any(isinstance(module, nn.BatchNorm2d) for module in discriminator.modules()):
            raise InputError(
                "WassersteinGradientPenalty needs a discriminator without batch norm; "
                "give it norm: instance or norm: none."
            )

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return E D(fake) - E D(real)."""
        return mean_over_heads(fake) - mean_over_heads(real)

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return -E D(fake)."""
        return -mean_over_heads(fake)

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        """Return λ E (‖∇D(x)‖₂ - 1)², x drawn on the lines between true and painted maps."""
        share = torch.rand(len(real), 1, 1, 1, device=real.device, dtype=real.dtype)
        between = (share * real + (1 - share) * fake).requires_grad_()
        # A score a sample (the mean over its elements and heads), summed: samples do not share gradients.
        score = torch.stack([head.float().flatten(1).mean(1) for head in critic(between)]).mean(0).sum()
        (gradient,) = torch.autograd.grad(score, between, create_graph=True)
        penalty: Tensor = self.gradient_penalty * (gradient.flatten(1).norm(dim=1) - 1).square().mean()
        return penalty
