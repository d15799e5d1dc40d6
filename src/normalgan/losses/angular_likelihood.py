"""AngularLikelihood: directions by their likelihood under the painted confidence, the object by its mask."""

import math
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.errors import InputError
from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.models.predictions import Predictions

__all__ = ["AngularLikelihood", "angular_nll", "relief_error", "smooth_angle"]

_TINY = 1e-6  # of a length or its square: at a right or an opposite direction the angle has no gradient


def angular_nll(angle: Tensor, confidence: Tensor) -> Tensor:
    """Return the negative log-likelihood of an angular error, up to a constant.

    Of the angular von Mises-Fisher distribution, whose density falls by exp(-κ θ): unlike that of the plain
    one its mode is sharp, so that it is the mean angle that is made small and not its square.

    Args:
        angle: θ in radians, of any shape.
        confidence: κ of the same shape, positive; the larger, the surer.

    References:
        Bae, Budvytis, Cipolla 2021, "Estimating and Exploiting the Aleatoric Uncertainty in Surface Normal
        Estimation", equation 5.
    """
    return (
        torch.log1p(torch.exp(-confidence * math.pi))
        - torch.log(confidence.square() + 1)
        + confidence * angle
    )


def smooth_angle(one: Tensor, other: Tensor) -> Tensor:
    """Return the angles in radians, (N, 1, H, W), between vectors (N, 3, H, W); their gradient is finite."""
    across = torch.linalg.cross(one, other, dim=1).square().sum(1, keepdim=True)
    return torch.atan2((across + _TINY**2).sqrt(), (one * other).sum(1, keepdim=True))


def relief_error(direction: Tensor, target: Tensor, mask: Tensor) -> Tensor:
    """Return how far the mean n_z of parts of the object is off, a scalar; parts are cells of an 8 × 8 grid.

    Args:
        direction: (N, 3, H, W) unit normals.
        target: (N, 3, H, W) true ones.
        mask: (N, 1, H, W), 1 on the object.
    """
    off = (direction[:, 2:] - target[:, 2:]) * mask
    parts = F.adaptive_avg_pool2d(off, 8).abs().sum()
    return parts / F.adaptive_avg_pool2d(mask, 8).sum().clamp(min=1e-6)


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class AngularLikelihood(Reconstruction):
    """Likelihood of the true directions on the object, and cross-entropy of where the object is.

    Needs a generator whose `Generator.predict` says the presence of an object and the confidence κ in its
    direction.

    Args:
        presence_weight: weight of the cross-entropy of the mask, a mean over all pixels.
        angle_weight: weight of the mean angle in radians, from which alone directions learn, every pixel
            alike; the likelihood then teaches the confidence alone. With 0 both learn from the likelihood, in
            which a pixel that is unsure counts less.
        relief_weight: weight of how far the mean n_z of a part of the object is off. Where a direction is
            uncertain, the one of the least mean angle is nearer to the viewer than most of those possible;
            this holds the surface to turning away as far as it does on average.
        stride: of each square of pixels of this side only one is compared, drawn anew at each step;
            neighbours say nearly the same, and whole pictures take long.
        likelihood_weight: weight of the likelihood. With 0, and an ``angle_weight``, no confidence is learnt.

    Raises:
        InputError: if a weight is negative, or, when training, the generator says no presence or confidence.
    """

    presence_weight: float = 0.5
    angle_weight: float = 0.0
    relief_weight: float = 0.0
    stride: int = 1
    likelihood_weight: float = 1.0

    def __post_init__(self) -> None:
        for name in ("presence_weight", "angle_weight", "relief_weight", "likelihood_weight"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} must be 0 or more, not {getattr(self, name)}.")
        if self.stride < 1:
            raise InputError(f"stride must be 1 or more, not {self.stride}.")

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return likelihood, angle (if it has a weight) and presence; see `Reconstruction.terms`."""
        if preds.presence is None or preds.confidence is None:
            lacks = [name for name in ("presence", "confidence") if getattr(preds, name) is None]
            raise InputError(
                "AngularLikelihood needs a generator whose predict() gives the presence of an object and a "
                f"confidence, such as ResidualUNetGenerator; this one gives no {' and no '.join(lacks)}."
            )
        top, left = torch.randint(self.stride, (2,)).tolist() if self.stride > 1 else (0, 0)
        chosen = (..., slice(top, None, self.stride), slice(left, None, self.stride))
        direction, target, mask = preds.direction[chosen], target[chosen], mask[chosen]
        angle = smooth_angle(direction, target)
        nll = angular_nll(angle.detach() if self.angle_weight else angle, preds.confidence[chosen])
        terms = {"likelihood": Term(_mean_on(mask, nll), self.likelihood_weight)}
        if self.angle_weight:
            terms["angle"] = Term(_mean_on(mask, angle), self.angle_weight)
        if self.relief_weight:
            terms["relief"] = Term(relief_error(direction, target, mask), self.relief_weight)
        presence = F.binary_cross_entropy_with_logits(preds.presence[chosen], mask)
        return {**terms, "presence": Term(presence, self.presence_weight)}


def _mean_on(mask: Tensor, values: Tensor) -> Tensor:
    return (values * mask).sum() / mask.sum().clamp(min=1)
