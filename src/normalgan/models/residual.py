"""Residual blocks, with or without norms."""

from torch import Tensor, nn

from normalgan.models.blocks import Norm, norm_layer

__all__ = ["ResidualBlock", "residual_blocks"]


class ResidualBlock(nn.Module):
    """Adds to its input what two convolutions make of it: x + conv(SiLU(norm(conv(SiLU(norm(x)))))).

    Norm and activation first (He et al. 2016, "Identity Mappings in Deep Residual Networks"). Without norms
    the second convolution starts at zero, so that a deep network begins as a shallow one (Zhang et al. 2019,
    "Fixup Initialization", whose first rule this is).

    Args:
        channels: of the input and the output.
        norm: before each activation.
    """

    def __init__(self, channels: int, norm: Norm = "none") -> None:
        super().__init__()
        self.first_norm = norm_layer(norm, channels)
        self.first = nn.Conv2d(channels, channels, 3, padding=1)
        self.second_norm = norm_layer(norm, channels)
        self.second = nn.Conv2d(channels, channels, 3, padding=1)
        self.activation = nn.SiLU()
        if norm == "none":
            for parameter in self.second.parameters():
                nn.init.zeros_(parameter)

    def forward(self, features: Tensor) -> Tensor:
        """Return features of the same shape (N, C, H, W)."""
        change: Tensor = self.first(self.activation(self.first_norm(features)))
        change = self.second(self.activation(self.second_norm(change)))
        return features + change


def residual_blocks(channels: int, count: int, norm: Norm = "none") -> nn.Sequential:
    """Return ``count`` residual blocks, one after the other."""
    return nn.Sequential(*(ResidualBlock(channels, norm) for _ in range(count)))
