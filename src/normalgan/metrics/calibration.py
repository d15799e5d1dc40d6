"""Calibration: whether a generator's confidence says how large its errors are."""

import math
from dataclasses import dataclass, field

import torch
from torch import Tensor

__all__ = ["BIN", "Calibration", "expected_angle"]

BIN = 2.0
"""Degrees of predicted error that share a bin of the curve."""
_BINS = math.ceil(90 / BIN)


def expected_angle(confidence: Tensor) -> Tensor:
    """Return the mean angular error in degrees that a confidence κ promises, 0…90.

    The mean of the angular von Mises-Fisher distribution, whose density on the sphere falls by exp(-κ θ):
    2κ / (κ² + 1) + π / (1 + exp(κπ)).

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
    """Counts predicted and observed errors of pixels, in bins of the predicted one.

    Args:
        sums: (bins, 3): pixels, sum of the predicted and sum of the observed errors in degrees.
    """

    sums: Tensor = field(default_factory=lambda: torch.zeros(_BINS, 3, dtype=torch.float64))

    def update(self, predicted: Tensor, observed: Tensor, mask: Tensor) -> None:
        """Count pixels.

        Args:
            predicted: (N, 1, H, W) degrees, 0…90.
            observed: (N, 1, H, W) degrees.
            mask: (N, 1, H, W), 1 where pixels count.
        """
        inside = mask > 0.5
        predicted, observed = predicted[inside].double().cpu(), observed[inside].double().cpu()
        bins = (predicted / BIN).long().clamp(0, _BINS - 1)
        values = torch.stack([torch.ones_like(predicted), predicted, observed], dim=1)
        self.sums = self.sums.index_add(0, bins, values)

    def curve(self) -> list[dict[str, float]]:
        """Return ``pixels`` and mean ``predicted`` and ``observed`` degrees of each bin that is not empty."""
        return [
            {"pixels": int(count), "predicted": float(said / count), "observed": float(seen / count)}
            for count, said, seen in self.sums
            if count and math.isfinite(said + seen)
        ]

    def error(self) -> float:
        """Return the expected calibration error: the mean over pixels of their bin's |observed - predicted|.

        Degrees; nan if there are no pixels.
        """
        count, said, seen = self.sums.unbind(1)
        return float((seen - said).abs().sum() / count.sum()) if count.sum() else math.nan
