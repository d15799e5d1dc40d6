"""AngularLikelihood: likelihood of normals given a predicted confidence, plus cross-entropy of the mask."""

import math
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.errors import InputError
from normalgan.losses.reconstruction import RECONSTRUCTIONS, Reconstruction, Term
from normalgan.models.predictions import Predictions
from normalgan.ranges import NonNegative, PositiveInt

_GRID = 8  # cells along each side of the grid in which the relief is compared
_TINY = 1e-6  # lower bound of a length or its square, because the angle has no gradient at 0 and 180°


def angular_nll(angle: Tensor, confidence: Tensor) -> Tensor:
    """Return the negative log-likelihood of an angular error, up to a constant.

    The distribution is the angular von Mises-Fisher distribution, with density proportional to exp(-κ θ).
    It has a sharper mode than the plain one, so the likelihood minimises the mean angle instead of the
    mean squared angle.

    Args:
        angle: θ in radians, of any shape.
        confidence: κ of the same shape, positive; larger means more certain.

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
    """Return the angles in radians, (N, 1, H, W), between vectors (N, 3, H, W), with finite gradients."""
    across = torch.linalg.cross(one, other, dim=1).square().sum(1, keepdim=True)
    return torch.atan2((across + _TINY**2).sqrt(), (one * other).sum(1, keepdim=True))


def relief_error(direction: Tensor, target: Tensor, mask: Tensor) -> Tensor:
    """Return the error of the mean n_z in the cells of an 8 × 8 grid, a scalar.

    Args:
        direction: (N, 3, H, W) unit normals.
        target: (N, 3, H, W) true unit normals.
        mask: (N, 1, H, W), 1 on the object.
    """
    off = (direction[:, 2:] - target[:, 2:]) * mask
    in_cells = F.adaptive_avg_pool2d(off, _GRID).abs().sum()
    return in_cells / F.adaptive_avg_pool2d(mask, _GRID).sum().clamp(min=1e-6)


@RECONSTRUCTIONS.register
@dataclass(frozen=True)
class AngularLikelihood(Reconstruction):
    """Likelihood of the true normals on the object, plus cross-entropy of the object mask.

    The generator's `Generator.predict` must return presence and confidence κ.

    Args:
        presence_weight: weight of the mask's cross-entropy, a mean over all pixels.
        angle_weight: weight of the mean angle in radians. If positive, normals are trained on the angle
            only, with equal weight for every pixel, and the likelihood trains only the confidence. If 0,
            both are trained on the likelihood, in which uncertain pixels count less.
        relief_weight: weight of the error of the mean n_z over parts of the object. Minimising the mean
            angle makes uncertain normals face the viewer, and this term keeps the surface from flattening.
        stride: side of squares of pixels; only one pixel per square is compared, a different one at each
            step. Larger is faster, and neighbouring pixels are nearly equal.
        likelihood_weight: weight of the likelihood. With 0 and an ``angle_weight``, no confidence is learnt.

    Raises:
        InputError: if a weight is negative or, in training, the generator predicts no presence or
            confidence.
    """

    presence_weight: NonNegative = 0.5
    angle_weight: NonNegative = 0.0
    relief_weight: NonNegative = 0.0
    stride: PositiveInt = 1
    likelihood_weight: NonNegative = 1.0

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        """Return likelihood, angle (if its weight is positive) and presence; see `Reconstruction.terms`."""
        if preds.presence is None or preds.confidence is None:
            lacks = [name for name in ("presence", "confidence") if getattr(preds, name) is None]
            raise InputError(
                "AngularLikelihood needs a generator whose predict() gives the presence of an object and a "
                f"confidence, such as ResidualUNetGenerator; this one gives no {' and no '.join(lacks)}."
            )
        # From torch's global generator, which each training step seeds.
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
