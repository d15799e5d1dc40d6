"""Calibration: how well a generator's confidence predicts its errors."""

import math
from dataclasses import dataclass, field

import torch
from torch import Tensor

BIN = 2.0
"""Width of a bin of the curve, in degrees of predicted error."""
_BINS = math.ceil(90 / BIN)


def expected_angle(confidence: Tensor) -> Tensor:
    """Return the expected angular error in degrees, 0…90, for a confidence κ.

    This is the mean of the angular von Mises-Fisher distribution, with density proportional to exp(-κ θ)
    on the sphere: 2κ / (κ² + 1) + π / (1 + exp(κπ)).

    Args:
        confidence: κ of any shape, 0 or more.

    References:
        Bae, Budvytis, Cipolla 2021, "Estimating and Exploiting the Aleatoric Uncertainty in Surface Normal
        Estimation", equation 5.

    Example:
        >>> [round(v, 2) for v in expected_angle(torch.tensor([0.0, 1.0, 10.0])).tolist()]
        [90.0, 64.75, 11.35]
    """
    kappa = confidence.double()
    return torch.rad2deg(2 * kappa / (kappa.square() + 1) + math.pi * torch.sigmoid(-kappa * math.pi))


@dataclass
class Calibration:
    """Predicted and observed errors of pixels, in bins of the predicted error.

    Args:
        sums: (bins, 3): number of pixels, sum of predicted errors and sum of observed errors, in degrees.
    """

    sums: Tensor = field(default_factory=lambda: torch.zeros(_BINS, 3, dtype=torch.float64))

    def update(self, predicted: Tensor, observed: Tensor, mask: Tensor) -> None:
        """Add pixels.

        Args:
            predicted: (N, 1, H, W) predicted errors in degrees, 0…90.
            observed: (N, 1, H, W) observed errors in degrees.
            mask: (N, 1, H, W), 1 at counted pixels.
        """
        inside = mask > 0.5
        predicted, observed = predicted[inside].double().cpu(), observed[inside].double().cpu()
        bins = (predicted / BIN).long().clamp(0, _BINS - 1)
        values = torch.stack([torch.ones_like(predicted), predicted, observed], dim=1)
        self.sums = self.sums.index_add(0, bins, values)

    def curve(self) -> list[dict[str, float]]:
        """Return ``pixels`` and the mean ``predicted`` and ``observed`` degrees of each non-empty bin."""
        return [
            {"pixels": int(count), "predicted": float(predicted / count), "observed": float(observed / count)}
            for count, predicted, observed in self.sums
            if count and math.isfinite(predicted + observed)
        ]

    def error(self) -> float:
        """Return the expected calibration error in degrees, or nan if there are no pixels.

        It is the mean over pixels of the |observed - predicted| of their bins.
        """
        count, predicted, observed = self.sums.unbind(1)
        return float((observed - predicted).abs().sum() / count.sum()) if count.sum() else math.nan
