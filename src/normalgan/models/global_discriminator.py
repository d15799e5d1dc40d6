"""GlobalDiscriminator: Sketch2Normal's critic, with one score per picture."""

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.base import DISCRIMINATORS, INPUT_CHANNELS, Discriminator
from normalgan.models.blocks import Norm, down, init_weights, norm_layer
from normalgan.ranges import PositiveInt, check_ranges


@DISCRIMINATORS.register
class GlobalDiscriminator(Discriminator):
    """Sketch2Normal's critic: four 5 × 5 convolutions and a fully connected layer to one score.

    Args:
        size: side of the pictures, a multiple of 8. Linked to the size of the data on the command line.
        width: channels of the first layer.
        norm: batch, instance or none; must not be batch with a gradient penalty.

    References:
        Su et al. 2018, "Interactive Sketch-Based Normal Map Generation with Deep Neural Networks".
    """

    def __init__(self, size: int = 256, width: PositiveInt = 64, norm: Norm = "batch") -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        if size < 8 or size % 8:
            raise InputError(f"size of GlobalDiscriminator is {size}; it must be a multiple of 8.")
        self.size = size
        widths = [width * 2**i for i in range(4)]
        modules: list[nn.Module] = [down(INPUT_CHANNELS - 1 + 3, width, 5, bias=True), nn.LeakyReLU(0.2)]
        for before, after, stride in zip(widths, widths[1:], (2, 2, 1), strict=False):
            modules += [down(before, after, 5, True, stride), norm_layer(norm, after), nn.LeakyReLU(0.2)]
        modules += [nn.Flatten(), nn.Linear(widths[-1] * (size // 8) ** 2, 1)]
        self.body = nn.Sequential(*modules)
        self.apply(init_weights)

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return one score per picture, (N, 1).

        Raises:
            InputError: if the pictures do not have the size that the network was built for.
        """
        if normal.shape[-2:] != (self.size, self.size):
            raise InputError(
                f"GlobalDiscriminator was built for {self.size} × {self.size} pixels, "
                f"not {normal.shape[-2]} × {normal.shape[-1]}."
            )
        return (self.body(torch.cat([condition[:, : INPUT_CHANNELS - 1], normal], dim=1)),)
