"""Layers shared by several networks: convolutions by kernel size, norms by name, initial weights."""

from typing import Literal

from torch import nn

__all__ = ["Norm", "down", "init_weights", "norm_layer", "up"]

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
