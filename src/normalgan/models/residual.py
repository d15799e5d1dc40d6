"""Residual blocks without norms: what they compute does not depend on the other pictures of a batch."""

from torch import Tensor, nn


class ResidualBlock(nn.Module):
    """Adds to its input what two convolutions make of it: x + conv(SiLU(conv(SiLU(x)))).

    Activation first (He et al. 2016, "Identity Mappings in Deep Residual Networks"); the second convolution
    starts at zero, so that a deep network begins as a shallow one and needs no norm (Zhang et al. 2019,
    "Fixup Initialization", whose first rule this is).

    Args:
        channels: of the input and the output.
    """

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(channels, channels, 3, padding=1)
        self.second = nn.Conv2d(channels, channels, 3, padding=1)
        self.activation = nn.SiLU()
        for parameter in self.second.parameters():
            nn.init.zeros_(parameter)

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        change: Tensor = self.second(self.activation(self.first(self.activation(features))))
        return features + change


def residual_blocks(channels: int, count: int) -> nn.Sequential:
    """Return ``count`` residual blocks, one after the other."""
    return nn.Sequential(*(ResidualBlock(channels) for _ in range(count)))
