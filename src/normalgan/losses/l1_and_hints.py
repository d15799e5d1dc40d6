"""L1AndHints: the paper's reconstruction loss, and its two terms."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.models.predictions import Predictions
from normalgan.ranges import NonNegative


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class L1AndHints(Reconstruction):
    """L1 loss on the whole map plus L1 loss at the hints (He et al. 2021, equations 5 and 6).

    Args:
        l1_weight: weight of the L1 loss (a mean over pixels and channels).
        hint_weight: weight of the hint loss (a mean over hints, a sum over channels), always on the raw map.
        composited: whether the L1 loss is computed after the true normals are pasted in at the hints, as
            by Su et al., instead of on the raw map.
    """

    l1_weight: NonNegative = 500.0
    hint_weight: NonNegative = 15.0
    composited: bool = False

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return the L1 loss and the hint loss; see `Reconstruction.terms`."""
        predicted = preds.normal
        compared = torch.where(where > 0.5, target, predicted) if self.composited else predicted
        hinted = predicted if self.hint_weight else predicted.detach()  # only logged, so no backward pass
        return {
            "l1": Term(l1_loss(compared, target), self.l1_weight),
            "hint": Term(hint_loss(hinted, target, where), self.hint_weight),
        }


def l1_loss(preds: Tensor, target: Tensor) -> Tensor:
    """Return the mean absolute difference over pixels and channels (He et al. 2021, equation 5).

    Args:
        preds: predicted normals (N, 3, H, W).
        target: true normals (N, 3, H, W).
    """
    return (preds - target).abs().mean()


def hint_loss(preds: Tensor, target: Tensor, where: Tensor) -> Tensor:
    """Return the L1 difference at hints, summed over channels, averaged over hints (He et al. 2021, eq. 6).

    Apply it to the raw output of the generator; after the true normals are pasted in at the hints, it is
    always 0. It is also 0 if there are no hints.

    Args:
        preds: predicted normals (N, 3, H, W), before the true normals are pasted in.
        target: true normals (N, 3, H, W).
        where: (N, 1, H, W), 1 at the hints.
    """
    return ((preds - target).abs() * where).sum() / where.sum().clamp(min=1)
