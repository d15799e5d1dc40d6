"""AdversarialObjective: what the discriminator and the generator want of the scores."""

from abc import ABC, abstractmethod
from collections.abc import Callable

import torch
from torch import Tensor, nn

from normalgan.registry import Registry

__all__ = ["ADVERSARIAL_OBJECTIVES", "AdversarialObjective", "Critic", "Scores", "mean_over_heads"]

Scores = tuple[Tensor, ...]
"""Raw scores of a discriminator, a tensor a head; see `Discriminator.forward`."""

Critic = Callable[[Tensor], Scores]
"""A discriminator with the condition already given: normals (N, 3, H, W) to scores."""


class AdversarialObjective(ABC):
    """Base of the adversarial objectives; every loss is to be minimised."""

    @abstractmethod
    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return the discriminator's loss, a scalar, for the scores of true and of painted maps."""

    @abstractmethod
    def generator_loss(self, fake: Scores) -> Tensor:
        """Return the generator's adversarial loss, a scalar, for the scores of its painted maps."""

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        """Return what is added to the discriminator's loss for the shape of the critic; 0 by default.

        Args:
            critic: the discriminator under its condition.
            real: true normals (N, 3, H, W).
            fake: painted normals (N, 3, H, W), detached.
        """
        return real.new_zeros(())

    def after_discriminator_step(self, discriminator: nn.Module) -> None:
        """Change the discriminator after its optimiser's step; nothing by default."""

    def check(self, discriminator: nn.Module) -> None:
        """Raise `InputError` if the objective cannot work with the discriminator."""


def mean_over_heads(scores: Scores) -> Tensor:
    """Return the mean score, a scalar; heads count equally, whatever their number of elements."""
    return torch.stack([score.float().mean() for score in scores]).mean()  # bfloat16 would round a mean


ADVERSARIAL_OBJECTIVES: Registry[AdversarialObjective] = Registry(
    AdversarialObjective,  # type: ignore[type-abstract]
    "normalgan.adversarial_objectives",
)
