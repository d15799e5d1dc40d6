"""AdversarialObjective: losses of discriminator and generator as functions of the scores."""

from abc import ABC, abstractmethod
from collections.abc import Callable

import torch
from torch import Tensor, nn

from normalgan.ranges import RangeChecked
from normalgan.registry import Registry

Scores = tuple[Tensor, ...]
"""Raw scores of a discriminator, one tensor per head; see `Discriminator.forward`."""

Critic = Callable[[Tensor], Scores]
"""A discriminator with a fixed condition: maps normals (N, 3, H, W) to scores."""


class AdversarialObjective(RangeChecked, ABC):
    """Base class of adversarial objectives; all losses are minimised."""

    @abstractmethod
    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return the discriminator's loss, a scalar, for the scores of true and predicted maps."""

    @abstractmethod
    def generator_loss(self, fake: Scores) -> Tensor:
        """Return the generator's adversarial loss, a scalar, for the scores of its predictions."""

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        """Return a regulariser to add to the discriminator's loss; 0 by default.

        Args:
            critic: the discriminator with its condition fixed.
            real: true normals (N, 3, H, W).
            fake: predicted normals (N, 3, H, W), detached.
        """
        return real.new_zeros(())

    def after_discriminator_step(self, discriminator: nn.Module) -> None:
        """Modify the discriminator after its optimiser's step; does nothing by default."""

    def check(self, discriminator: nn.Module) -> None:
        """Raise `InputError` if the objective cannot work with the discriminator."""


def mean_over_heads(scores: Scores) -> Tensor:
    """Return the mean score, a scalar; all heads have equal weight."""
    return torch.stack([score.float().mean() for score in scores]).mean()  # bfloat16 would round the mean


ADVERSARIAL_OBJECTIVES: Registry[AdversarialObjective] = Registry(
    AdversarialObjective,  # type: ignore[type-abstract]
    "normalgan.adversarial_objectives",
)
