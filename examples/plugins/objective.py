"""An adversarial objective: two losses of scores, both to be minimised."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.losses import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Scores
from normalgan.testing import check


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class LeastSquares(AdversarialObjective):
    """Least-squares GAN: scores of true maps to 1, of predicted ones to 0 (Mao et al. 2017)."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return half the mean of (D(real) - 1)² and D(fake)²."""
        heads = [(r - 1).square().mean() + f.square().mean() for r, f in zip(real, fake, strict=True)]
        return torch.stack(heads).mean() / 2

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return the mean of (D(fake) - 1)²."""
        return torch.stack([(f - 1).square().mean() for f in fake]).mean()


if __name__ == "__main__":
    check(LeastSquares())
