"""UNetDiscriminator: the paper's discriminator, of the generator's own shape."""

import torch
from torch import Tensor, nn

from normalgan.models.base import DISCRIMINATORS, INPUT_CHANNELS, Discriminator
from normalgan.models.blocks import Norm, init_weights
from normalgan.models.unet import UNet, full_depth

__all__ = ["UNetDiscriminator"]


@DISCRIMINATORS.register
class UNetDiscriminator(Discriminator):
    """The paper's discriminator: "the same architecture and depth as the generator", a score a pixel.

    It sees the sketch with the hint normals painted in, and the map; 6 channels, as Sketch2Normal's does.

    Args:
        size: side of the pictures; sets the depth. Linked to the size of the data on the command line.
        width: channels of the first layer.
        depth: layers down, and again up; None for as many as lead to a single pixel (8 at 256).
        kernel: side of the convolutions.
        norm: batch, instance or none; a gradient penalty forbids batch.
        encoder_head: add one score of the whole picture, taken at the innermost layer.
        see_mask: show it the mask of the hints as a seventh channel.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling", 3.2;
        Schönfeld et al. 2020, "A U-Net Based Discriminator for Generative Adversarial Networks".
    """

    def __init__(
        self,
        size: int = 256,
        width: int = 64,
        depth: int | None = None,
        kernel: int = 4,
        norm: Norm = "batch",
        encoder_head: bool = False,
        see_mask: bool = False,
    ) -> None:
        super().__init__()
        self.condition_channels = INPUT_CHANNELS if see_mask else INPUT_CHANNELS - 1
        self.unet = UNet(
            self.condition_channels + 3,
            1,
            width=width,
            depth=full_depth(size) if depth is None else depth,
            kernel=kernel,
            norm=norm,
        )
        self.encoder_head = nn.Linear(self.unet.widths[-1], 1) if encoder_head else None
        if self.encoder_head is not None:
            init_weights(self.encoder_head)

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return the score map (N, 1, H, W), and (N, 1) from the encoder head if there is one."""
        scores, innermost = self.unet(torch.cat([condition[:, : self.condition_channels], normal], dim=1))
        if self.encoder_head is None:
            return (scores,)
        # Sum pooling after an activation, as Schönfeld et al. have it.
        return scores, self.encoder_head(torch.relu(innermost).sum(dim=(2, 3)))
