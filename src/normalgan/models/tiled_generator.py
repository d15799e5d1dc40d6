"""TiledGenerator: predicts window by window at three scales, like DeepNormals."""

from itertools import pairwise

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.base import GENERATORS, Generator
from normalgan.models.blocks import Norm, check_levels, residual_blocks
from normalgan.ranges import PositiveInt, check_ranges

SCALES = (1, 2, 4)
"""Widths of the areas shown by the input channels, in window widths."""


@GENERATORS.register
class TiledGenerator(Generator):
    """A residual encoder and decoder over overlapping windows of a sketch, each at three scales.

    This follows DeepNormals and ignores hints. Windows overlap by half and are blended with higher weights
    at their centres to avoid visible seams. The network sees four times the width of a window, at any
    picture size.

    Args:
        window: side of the windows in pixels, a multiple of 16. The sides of a picture must be multiples
            of half the window.
        widths: channels of each level of the network, from the finest to the coarsest.
        blocks: residual blocks per level, in the encoder and again in the decoder.
        norm: norm of the residual blocks; batch norm computes its statistics over all windows of a batch.

    Raises:
        InputError: if a setting is invalid.

    References:
        Hudon, Grogan, Pagés, Smolić 2018, "Deep Normal Estimation for Automatic Shading of Hand-Drawn
        Characters", ECCV Workshops. The differences are listed in docs/method.md.
    """

    def __init__(
        self,
        window: int = 64,
        widths: tuple[PositiveInt, ...] = (32, 64, 128, 256),
        blocks: tuple[PositiveInt, ...] = (1, 1, 1, 2),
        norm: Norm = "batch",
    ) -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        check_levels(self, widths, blocks)
        if window < 16 or window % 16:
            raise InputError(f"the window of TiledGenerator is a multiple of 16 pixels, not {window}.")
        if window % 2 ** (len(widths) - 1):
            raise InputError(f"a window of {window} pixels cannot be halved {len(widths) - 1} times.")
        self.window = window
        self.step = window // 2
        levels = list(zip(widths, blocks, strict=True))
        pairs = list(pairwise(widths))
        self.stem = nn.Conv2d(len(SCALES), widths[0], 3, padding=1)
        self.encoder = nn.ModuleList([residual_blocks(*level, norm) for level in levels])
        self.downs = nn.ModuleList([nn.Conv2d(fine, coarse, 2, 2) for fine, coarse in pairs])
        self.ups = nn.ModuleList([nn.ConvTranspose2d(coarse, fine, 2, 2) for fine, coarse in pairs])
        self.merges = nn.ModuleList([nn.Conv2d(2 * fine, fine, 1) for fine, _ in pairs])
        self.decoder = nn.ModuleList([residual_blocks(*level, norm) for level in levels[:-1]])
        self.head = nn.Conv2d(widths[0], 3, 3, padding=1)

    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W) in [-1, 1] for a condition (N, 4, H, W).

        Raises:
            InputError: if a side is not a multiple of half a window.
        """
        height, width = condition.shape[2:]
        if height % self.step or width % self.step:
            raise InputError(
                f"this generator needs sides that are multiples of {self.step}, "
                f"not {height} × {width} pixels."
            )
        # Ink 1, paper 0 like the padding. At hints, the condition holds no sketch, so they count as paper.
        ink = (1 - condition[:, :1]) / 2 * (1 - condition[:, 3:])
        predicted = self._predict(self._windows(ink))
        return self._join(torch.tanh(predicted.to(condition.dtype)), height, width)

    def _windows(self, ink: Tensor) -> Tensor:
        """Return the windows of a batch, (N · T, scales, window, window), centred alike at all scales."""
        parts = []
        for scale in SCALES:
            shrunk = F.avg_pool2d(ink, scale) if scale > 1 else ink
            edge = self.window // 2 - self.step // (2 * scale)
            parts.append(_unfold(shrunk, self.window, self.step // scale, edge))
        return torch.cat(parts, dim=1)

    def _predict(self, windows: Tensor) -> Tensor:
        features = self.stem(windows)
        skips = []
        for blocks, down in zip(self.encoder, self.downs, strict=False):
            features = blocks(features)
            skips.append(features)
            features = down(features)
        features = self.encoder[-1](features)
        for i in reversed(range(len(self.ups))):
            features = self.merges[i](torch.cat([self.ups[i](features), skips[i]], dim=1))
            features = self.decoder[i](features)
        predicted: Tensor = self.head(F.silu(features))
        return predicted

    def _join(self, predicted: Tensor, height: int, width: int) -> Tensor:
        """Blend windows (N · T, 3, window, window) into pictures (N, 3, H, W)."""
        tiles = (height // self.step) * (width // self.step)
        edge = self.window // 2 - self.step // 2
        place = torch.arange(self.window, dtype=predicted.dtype, device=predicted.device)
        along = 1 - (place + 0.5 - self.step).abs() / self.step  # above 0 at every pixel
        weight = along[:, None] * along
        flat = (predicted * weight).reshape(-1, tiles, 3 * self.window**2).transpose(1, 2)
        shares = weight.flatten()[None, :, None].expand(1, -1, tiles)
        layout = {"kernel_size": self.window, "stride": self.step, "padding": edge}
        laid = F.fold(flat, (height, width), **layout)
        return laid / F.fold(shares, (height, width), **layout)


def _unfold(picture: Tensor, window: int, step: int, edge: int) -> Tensor:
    """Return windows (N · T, 1, window, window) of pictures (N, 1, H, W), row by row from the upper left."""
    columns = F.unfold(picture, window, stride=step, padding=edge)
    return columns.transpose(1, 2).reshape(-1, 1, window, window)
