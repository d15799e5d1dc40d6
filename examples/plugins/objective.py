"""An adversarial objective: two losses on scores, both minimised."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.losses import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Scores
from normalgan.testing import check


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class LeastSquares(AdversarialObjective):
    """Least-squares GAN (Mao et al. 2017): scores of true maps tend to 1, of predicted maps to 0."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return half the mean of (D(real) - 1)² and D(fake)²."""
        heads = [(r - 1).square().mean() + f.square().mean() for r, f in zip(real, fake, strict=True)]
        return torch.stack(heads).mean() / 2

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return the mean of (D(fake) - 1)²."""
        return torch.stack([(f - 1).square().mean() for f in fake]).mean()


if __name__ == "__main__":
    check(LeastSquares())
