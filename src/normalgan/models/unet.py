"""U-Nets: the paper's generator and discriminator, and the network that both share."""

from typing import Annotated

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.base import DISCRIMINATORS, GENERATORS, INPUT_CHANNELS, Discriminator, Generator
from normalgan.models.blocks import Norm, down, init_weights, norm_layer, up
from normalgan.ranges import PositiveInt, Range, UnitInterval, check_ranges

_Depth = Annotated[int, Range(2)]


class UNet(nn.Module):
    """Encoder and decoder of ``depth`` strided convolutions each, with a skip from layer i to layer n - i.

    Channels double from ``width`` to 8 × ``width`` in the encoder, and the decoder mirrors it. The
    outermost and the innermost layers have no norm, although the paper says "each layer": over the
    innermost single pixel, a norm would subtract the value from itself.

    Args:
        inputs: number of input channels.
        outputs: number of output channels, which have no activation.
        width: channels of the first layer; 64 in the published networks.
        depth: number of encoder layers and of decoder layers; sides must be multiples of 2 ** depth.
        kernel: kernel size of the convolutions: 4 in pix2pix, 5 in Sketch2Normal.
        norm: normalisation after each convolution.
        bias: whether layers before a norm have a bias too, as in Sketch2Normal.
        dropout: dropout probability in up to three innermost decoder layers of full width.

    References:
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks", 6.1.1.
    """

    def __init__(
        self,
        inputs: int,
        outputs: int,
        *,
        width: int,
        depth: int,
        kernel: int = 4,
        norm: Norm = "batch",
        bias: bool = False,
        dropout: float = 0.0,
    ) -> None:
        super().__init__()
        self.depth = depth
        self.widths = [width * min(2**i, 8) for i in range(depth)]
        bias = bias or norm == "none"
        self.encoder = nn.ModuleList()
        for i, after in enumerate(self.widths):
            before = self.widths[i - 1] if i else inputs
            layers: list[nn.Module] = [nn.LeakyReLU(0.2)] if i else []
            layers.append(down(before, after, kernel, bias))
            if 0 < i < depth - 1:
                layers.append(norm_layer(norm, after))
            self.encoder.append(nn.Sequential(*layers))
        self.decoder = nn.ModuleList()
        for step, i in enumerate(reversed(range(depth))):  # from the innermost layer outwards
            before = self.widths[i] * (2 if step else 1)  # all but the innermost also read a skip
            after = self.widths[i - 1] if i else outputs
            layers = [nn.ReLU(), up(before, after, kernel, bias or i == 0)]
            if i:
                layers.append(norm_layer(norm, after))
                if dropout and step < 3 and after == 8 * width:
                    layers.append(nn.Dropout(dropout))
            self.decoder.append(nn.Sequential(*layers))
        self.apply(init_weights)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Return the output (N, outputs, H, W) and the innermost features (N, 8 × width, h, w).

        Raises:
            InputError: if a side of ``x`` is not a multiple of 2 ** depth.
        """
        if x.shape[-1] % 2**self.depth or x.shape[-2] % 2**self.depth:
            raise InputError(
                f"a U-Net of depth {self.depth} needs sides that are multiples of {2**self.depth}, "
                f"not {x.shape[-2]} × {x.shape[-1]} pixels."
            )
        skips = []
        for layer in self.encoder:
            x = layer(x)
            skips.append(x)
        innermost = skips.pop()
        x = self.decoder[0](innermost)
        for layer in self.decoder[1:]:
            x = layer(torch.cat([x, skips.pop()], dim=1))
        return x, innermost


@GENERATORS.register
class UNetGenerator(Generator):
    """The paper's generator: a U-Net of 16 layers at 256 pixels, with tanh.

    The noise z is dropout, as in pix2pix. It is off in prediction unless ``noise_at_test`` is set.

    Args:
        size: side of the pictures, which determines the default depth. Linked to the size of the data on
            the command line.
        width: channels of the first layer.
        depth: number of encoder layers and of decoder layers; None goes down to a single pixel (8 layers
            at 256).
        kernel: kernel size of the convolutions: 4 in pix2pix, 5 in Sketch2Normal.
        norm: batch, instance or none. With a batch size of 1, batch and instance are the same in training.
        bias: whether layers before a norm have a bias too, as in Sketch2Normal.
        dropout: dropout probability in the innermost decoder layers.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling", 3.2;
        Isola et al. 2017, "Image-to-Image Translation with Conditional Adversarial Networks";
        Su et al. 2018, "Interactive Sketch-Based Normal Map Generation with Deep Neural Networks".
    """

    def __init__(
        self,
        size: int = 256,
        width: PositiveInt = 64,
        depth: _Depth | None = None,
        kernel: PositiveInt = 4,
        norm: Norm = "batch",
        bias: bool = False,
        dropout: UnitInterval = 0.5,
    ) -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        self.unet = UNet(
            INPUT_CHANNELS,
            3,
            width=width,
            depth=_full_depth(size) if depth is None else depth,
            kernel=kernel,
            norm=norm,
            bias=bias,
            dropout=dropout,
        )

    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W) in [-1, 1] for a condition (N, 4, H, W)."""
        output, _ = self.unet(condition)
        return torch.tanh(output if output.dtype == condition.dtype else output.float())  # bfloat16 saturates


@DISCRIMINATORS.register
class UNetDiscriminator(Discriminator):
    """The paper's discriminator: "the same architecture and depth as the generator", one score per pixel.

    Its input has 6 channels, as in Sketch2Normal: the sketch with hint normals pasted in, and the map.

    Args:
        size: side of the pictures, which determines the default depth. Linked to the size of the data on
            the command line.
        width: channels of the first layer.
        depth: number of encoder layers and of decoder layers; None goes down to a single pixel (8 layers
            at 256).
        kernel: kernel size of the convolutions.
        norm: batch, instance or none; must not be batch with a gradient penalty.
        encoder_head: whether to add a score for the whole picture from the innermost layer.
        see_mask: whether the hint mask is a seventh input channel.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling", 3.2;
        Schönfeld et al. 2020, "A U-Net Based Discriminator for Generative Adversarial Networks".
    """

    def __init__(
        self,
        size: int = 256,
        width: PositiveInt = 64,
        depth: _Depth | None = None,
        kernel: PositiveInt = 4,
        norm: Norm = "batch",
        encoder_head: bool = False,
        see_mask: bool = False,
    ) -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        self.condition_channels = INPUT_CHANNELS if see_mask else INPUT_CHANNELS - 1
        self.unet = UNet(
            self.condition_channels + 3,
            1,
            width=width,
            depth=_full_depth(size) if depth is None else depth,
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
        # Sum pooling after an activation, as in Schönfeld et al.
        return scores, self.encoder_head(torch.relu(innermost).sum(dim=(2, 3)))


def _full_depth(size: int) -> int:
    """Return the number of halvings from ``size`` pixels to a single pixel.

    Raises:
        InputError: if ``size`` is not a power of two.

    >>> _full_depth(256)
    8
    """
    if size < 4 or size & (size - 1):
        raise InputError(
            f"a U-Net down to one pixel needs a size that is a power of two, at least 4, not {size}."
        )
    return size.bit_length() - 1
