"""A discriminator, which returns a tuple of raw scores, one tensor per head; high means real."""

import torch
from torch import Tensor, nn

from normalgan.models import DISCRIMINATORS, INPUT_CHANNELS, Discriminator
from normalgan.testing import check


@DISCRIMINATORS.register
class SmallDiscriminator(Discriminator):
    """Scores patches of 10 × 10 pixels, and the whole picture.

    Args:
        width: channels inside.
    """

    def __init__(self, width: int = 16) -> None:
        super().__init__()
        self.body = nn.Sequential(nn.Conv2d(INPUT_CHANNELS + 3, width, 4, 2), nn.LeakyReLU(0.2))
        self.patches = nn.Conv2d(width, 1, 4)
        self.whole = nn.Linear(width, 1)

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return scores (N, 1, h, w) and (N, 1)."""
        features = self.body(torch.cat([condition, normal], dim=1))
        return self.patches(features), self.whole(features.mean((2, 3)))


if __name__ == "__main__":
    check(SmallDiscriminator(8), size=32)
