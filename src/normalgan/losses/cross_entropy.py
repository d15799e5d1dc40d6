"""CrossEntropy: the original GAN objective, as pix2pix uses it."""

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.losses.adversarial import ADVERSARIAL_OBJECTIVES, AdversarialObjective, Scores


def _cross_entropy(scores: Scores, target: float) -> Tensor:
    full = [score.float() for score in scores]  # scores may be bfloat16 under autocast
    losses = [F.binary_cross_entropy_with_logits(s, torch.full_like(s, target)) for s in full]
    return torch.stack(losses).mean()


@ADVERSARIAL_OBJECTIVES.register
@dataclass(frozen=True)
class CrossEntropy(AdversarialObjective):
    """Binary cross-entropy: non-saturating for the generator, halved for the discriminator.

    References:
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks", 3.3.
    """

    def discriminator_loss(self, real: Scores, fake: Scores) -> Tensor:
        """Return half the sum of -E log σ(D(real)) and -E log(1 - σ(D(fake)))."""
        return (_cross_entropy(real, 1.0) + _cross_entropy(fake, 0.0)) / 2

    def generator_loss(self, fake: Scores) -> Tensor:
        """Return -E log σ(D(fake))."""
        return _cross_entropy(fake, 1.0)
