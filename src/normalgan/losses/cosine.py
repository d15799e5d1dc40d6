"""CosineAndL2: cosine loss on the object plus squared distance everywhere."""

from dataclasses import dataclass

import torch.nn.functional as F
from torch import Tensor

from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.models.predictions import Predictions
from normalgan.ranges import NonNegative


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class CosineAndL2(Reconstruction):
    """One minus the cosine of predicted and true normals, and their squared distance.

    The cosine is averaged over the object, the distance over all pixels. Outside the object, the target is
    zero, which teaches the network where the object ends.

    Args:
        cosine_weight: weight of one minus the cosine.
        l2_weight: weight of the squared distance, summed over coordinates and averaged over pixels.
    """

    cosine_weight: NonNegative = 1.0
    l2_weight: NonNegative = 1.0

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return both terms; see `Reconstruction.terms`."""
        away = 1 - F.cosine_similarity(preds.normal, target, dim=1, eps=1e-6)[:, None]
        squared = (preds.normal - target).square().sum(1).mean()
        return {
            "cosine": Term((away * mask).sum() / mask.sum().clamp(min=1), self.cosine_weight),
            "l2": Term(squared, self.l2_weight),
        }
