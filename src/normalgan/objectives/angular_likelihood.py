"""AngularLikelihood: directions by their likelihood under the painted confidence, the object by its mask."""

import math
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.errors import InputError
from normalgan.objectives.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.predictions import Predictions

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

    Raises:
        InputError: if a weight is negative, or, when training, the generator says no presence or confidence.
    """

    presence_weight: float = 0.5
    angle_weight: float = 0.0

    def __post_init__(self) -> None:
        for name, weight in {"presence": self.presence_weight, "angle": self.angle_weight}.items():
            if weight < 0:
                raise InputError(f"{name}_weight must be 0 or more, not {weight}.")

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return likelihood, angle (if it has a weight) and presence; see `Reconstruction.terms`."""
        if preds.presence is None or preds.confidence is None:
            lacks = [name for name in ("presence", "confidence") if getattr(preds, name) is None]
            raise InputError(
                "AngularLikelihood needs a generator whose predict() gives the presence of an object and a "
                f"confidence, such as ResidualUNetGenerator; this one gives no {' and no '.join(lacks)}."
            )
        angle = smooth_angle(preds.direction, target)
        nll = angular_nll(angle.detach() if self.angle_weight else angle, preds.confidence)
        terms = {"likelihood": Term(_mean_on(mask, nll), 1.0)}
        if self.angle_weight:
            terms["angle"] = Term(_mean_on(mask, angle), self.angle_weight)
        presence = F.binary_cross_entropy_with_logits(preds.presence, mask)
        return {**terms, "presence": Term(presence, self.presence_weight)}


def _mean_on(mask: Tensor, values: Tensor) -> Tensor:
    return (values * mask).sum() / mask.sum().clamp(min=1)
