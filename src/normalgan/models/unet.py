"""The U-Net body shared by the paper's generator and its discriminator (pix2pix's unet_256 at full size)."""

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.blocks import Norm, down, init_weights, norm_layer, up

__all__ = ["UNet", "full_depth"]


def full_depth(size: int) -> int:
    """Return how often a picture of ``size`` pixels can be halved until one is left.

    Raises:
        InputError: if ``size`` is not a power of two.

    >>> full_depth(256)
    8
    """
    if size < 4 or size & (size - 1):
        raise InputError(
            f"a U-Net down to one pixel needs a size that is a power of two from 4 on, not {size}."
        )
    return size.bit_length() - 1


class UNet(nn.Module):
    """Encoder and decoder of ``depth`` strided convolutions each, with a skip from layer i to layer n - i.

    Channels double from ``width`` to 8 × ``width`` and mirror back. There is no norm in the outermost
    layers, nor in the innermost, although the paper says "each layer": over the single pixel that is left
    there a norm subtracts the value from itself.

    Args:
        inputs: channels that come in.
        outputs: channels that go out, without activation.
        width: channels of the first layer; 64 in the published networks.
        depth: layers of the encoder, and again of the decoder; sides must be multiples of 2 ** depth.
        kernel: side of the convolutions: 4 in pix2pix, 5 in Sketch2Normal.
        norm: what follows the convolutions.
        bias: whether layers before a norm have a bias too, as in Sketch2Normal.
        dropout: its probability in the innermost decoder layers, three at most, of the full width.

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
        if width < 1 or depth < 2:
            raise InputError(f"a U-Net has a width from 1 and a depth from 2 on, not {width} and {depth}.")
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
        for step, i in enumerate(reversed(range(depth))):
            before = self.widths[i] * (2 if step else 1)  # all but the innermost take the skip as well
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
