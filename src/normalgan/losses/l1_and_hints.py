"""L1AndHints: the paper's reconstruction loss."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.losses.pixel_losses import hint_loss, l1_loss
from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.models.predictions import Predictions
from normalgan.ranges import NonNegative, check_ranges

__all__ = ["L1AndHints"]


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class L1AndHints(Reconstruction):
    """L1 difference to the true map, and again at the hints (He et al. 2021, equations 5 and 6).

    Args:
        l1_weight: weight of the L1 loss (a mean over pixels and channels).
        hint_weight: weight of the hint loss (a mean over hints, a sum over channels), always on the raw map.
        composited: take the L1 loss on the map with the truth pasted in at the hints, where it is then 0, as
            Su et al. do. On the raw map otherwise.

    Raises:
        InputError: if a weight is negative.
    """

    l1_weight: NonNegative = 500.0
    hint_weight: NonNegative = 15.0
    composited: bool = False

    def __post_init__(self) -> None:
        check_ranges(self)

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return the L1 loss and the hint loss; see `Reconstruction.terms`."""
        predicted = preds.normal
        compared = torch.where(where > 0.5, target, predicted) if self.composited else predicted
        hinted = predicted if self.hint_weight else predicted.detach()  # for the log alone, no pass backward
        return {
            "l1": Term(l1_loss(compared, target), self.l1_weight),
            "hint": Term(hint_loss(hinted, target, where), self.hint_weight),
        }
