"""A reconstruction loss, which returns its terms by name, each with a scalar and a weight."""

from dataclasses import dataclass

from torch import Tensor

from normalgan.errors import InputError
from normalgan.losses import RECONSTRUCTIONS, Predictions, Reconstruction, Term
from normalgan.testing import check


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class SquaredOnObject(Reconstruction):
    """The squared difference to the true normals, with a smaller weight off the object.

    Args:
        background: the weight of a pixel off the object, 0 or more.
    """

    background: float = 0.1

    def __post_init__(self) -> None:
        if self.background < 0:
            raise InputError(f"background must be 0 or more, not {self.background}.")

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return the two terms of the loss."""
        square = (preds.normal - target).square().sum(1, keepdim=True)
        on, off = mask.sum().clamp(min=1), (1 - mask).sum().clamp(min=1)  # a picture may have no object
        return {
            "object": Term((square * mask).sum() / on, 100.0),
            "background": Term((square * (1 - mask)).sum() / off, 100.0 * self.background),
        }


if __name__ == "__main__":
    check(SquaredOnObject())
