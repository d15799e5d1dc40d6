"""UNetGenerator: the paper's 16-layer generator."""

import torch
from torch import Tensor

from normalgan.models.base import GENERATORS, INPUT_CHANNELS, Generator
from normalgan.models.blocks import Norm
from normalgan.models.unet import UNet, full_depth

__all__ = ["UNetGenerator"]


@GENERATORS.register
class UNetGenerator(Generator):
    """The paper's generator: a U-Net of 16 layers at 256 pixels, with tanh.

    Its noise z is dropout, as in pix2pix: on while training, off when predicting unless asked.

    Args:
        size: side of the pictures; sets the depth. Linked to the size of the data on the command line.
        width: channels of the first layer.
        depth: layers down, and again up; None for as many as lead to a single pixel (8 at 256).
        kernel: side of the convolutions: 4 in pix2pix, 5 in Sketch2Normal.
        norm: batch, instance or none. With one picture a batch, batch and instance are the same in training.
        bias: whether layers before a norm have a bias too, as in Sketch2Normal.
        dropout: its probability in the innermost decoder layers.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling", 3.2;
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks";
        Su et al. 2018, "Interactive Sketch-Based Normal Map Generation with Deep Neural Networks".
    """

    def __init__(
        self,
        size: int = 256,
        width: int = 64,
        depth: int | None = None,
        kernel: int = 4,
        norm: Norm = "batch",
        bias: bool = False,
        dropout: float = 0.5,
    ) -> None:
        super().__init__()
        self.unet = UNet(
            INPUT_CHANNELS,
            3,
            width=width,
            depth=full_depth(size) if depth is None else depth,
            kernel=kernel,
            norm=norm,
            bias=bias,
            dropout=dropout,
        )

    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W) in [-1, 1] for a condition (N, 4, H, W)."""
        output, _ = self.unet(condition)
        return torch.tanh(output if output.dtype == condition.dtype else output.float())  # bfloat16 saturates
