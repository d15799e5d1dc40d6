"""Layers shared by several networks: convolutions by kernel size, residual blocks, norms, initial weights."""

from collections.abc import Sequence
from typing import Literal

from torch import Tensor, nn

from normalgan.errors import InputError

Norm = Literal["batch", "instance", "none"]


def down(inputs: int, outputs: int, kernel: int, bias: bool, stride: int = 2) -> nn.Conv2d:
    """Return a convolution that halves the sides; with stride 1, an even kernel reduces them by one."""
    return nn.Conv2d(inputs, outputs, kernel, stride, padding=(kernel - 1) // 2, bias=bias)


def up(inputs: int, outputs: int, kernel: int, bias: bool) -> nn.ConvTranspose2d:
    """Return a transposed convolution that doubles the sides."""
    # With an odd kernel, the output size is ambiguous, because 2n - 1 and 2n both map to n.
    return nn.ConvTranspose2d(
        inputs, outputs, kernel, 2, padding=(kernel - 1) // 2, output_padding=kernel % 2, bias=bias
    )


def norm_layer(norm: Norm, channels: int) -> nn.Module:
    """Return a norm layer, affine as in pix2pix and Sketch2Normal."""
    match norm:
        case "batch":
            return nn.BatchNorm2d(channels)
        case "instance":
            return nn.InstanceNorm2d(channels, affine=True)
        case "none":
            return nn.Identity()


def init_weights(module: nn.Module) -> None:
    """Initialise a layer as pix2pix does: N(0, 0.02), norms around 1; for `nn.Module.apply`."""
    if isinstance(module, nn.Conv2d | nn.ConvTranspose2d | nn.Linear):
        nn.init.normal_(module.weight, 0.0, 0.02)
        if module.bias is not None:
            nn.init.zeros_(module.bias)
    elif isinstance(module, nn.BatchNorm2d | nn.InstanceNorm2d) and module.affine:
        nn.init.normal_(module.weight, 1.0, 0.02)
        nn.init.zeros_(module.bias)


def check_levels(network: nn.Module, widths: Sequence[int], blocks: Sequence[int]) -> None:
    """Check that a network has a width and a number of blocks for each of its levels.

    Raises:
        InputError: if the lists differ in length, or there are fewer than two levels.
    """
    if len(widths) != len(blocks) or len(widths) < 2:
        raise InputError(
            f"widths and blocks of {type(network).__name__} are {list(widths)} and {list(blocks)}; each must "
            "have a number for each of two or more levels."
        )


class ResidualBlock(nn.Module):
    """A residual block: x + conv(SiLU(norm(conv(SiLU(norm(x)))))).

    Norm and activation come before the convolution (He et al. 2016, "Identity Mappings in Deep Residual
    Networks"). Without norms the second convolution starts at zero, so that each block starts as the identity
    (Zhang et al. 2019, "Fixup Initialization", first rule).

    Args:
        channels: channels of the input and of the output.
        norm: norm before each activation.
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
    """Return ``count`` residual blocks in sequence."""
    return nn.Sequential(*(ResidualBlock(channels, norm) for _ in range(count)))
