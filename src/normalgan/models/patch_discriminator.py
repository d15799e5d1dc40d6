"""PatchDiscriminator: the PatchGAN of pix2pix."""

import torch
from torch import Tensor, nn

from normalgan.models.base import DISCRIMINATORS, INPUT_CHANNELS, Discriminator
from normalgan.models.blocks import Norm, init_weights, norm_layer
from normalgan.ranges import PositiveInt, check_ranges


@DISCRIMINATORS.register
class PatchDiscriminator(Discriminator):
    """PatchGAN: scores overlapping patches, 70 × 70 pixels with three layers.

    Args:
        width: channels of the first layer.
        layers: number of strided layers; 1, 2, 3, 4, 5 layers see patches of 16, 34, 70, 142, 286 pixels.
        norm: batch, instance or none; must not be batch with a gradient penalty.
        see_mask: whether the hint mask is a seventh input channel.

    References:
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks", 6.1.2.
    """

    def __init__(
        self, width: PositiveInt = 64, layers: PositiveInt = 3, norm: Norm = "batch", see_mask: bool = False
    ) -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        self.condition_channels = INPUT_CHANNELS if see_mask else INPUT_CHANNELS - 1
        bias = norm == "none"
        modules: list[nn.Module] = [nn.Conv2d(self.condition_channels + 3, width, 4, 2, 1), nn.LeakyReLU(0.2)]
        before = width
        for i in range(1, layers + 1):
            after = width * min(2**i, 8)
            stride = 2 if i < layers else 1
            modules += [
                nn.Conv2d(before, after, 4, stride, 1, bias=bias),
                norm_layer(norm, after),
                nn.LeakyReLU(0.2),
            ]
            before = after
        modules.append(nn.Conv2d(before, 1, 4, 1, 1))
        self.body = nn.Sequential(*modules)
        self.apply(init_weights)

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return one score per patch, (N, 1, h, w); 30 × 30 patches at 256 pixels."""
        return (self.body(torch.cat([condition[:, : self.condition_channels], normal], dim=1)),)
