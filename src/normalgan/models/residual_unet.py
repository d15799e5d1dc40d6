"""ResidualUNetGenerator: our network; a residual U-Net with unit normals, presence and confidence."""

from collections.abc import Callable
from itertools import pairwise
from typing import Literal

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.models.base import GENERATORS, Generator
from normalgan.models.blocks import check_levels, residual_blocks
from normalgan.models.predictions import Predictions
from normalgan.ranges import PositiveInt, check_ranges

_OUTPUTS = 5
"""Channels of the last layer: a direction (3), the logit of presence, and the confidence."""
_DETAIL = 16
"""Channels between the last two layers, which see the sketch again and place edges exactly on its lines."""


@GENERATORS.register
class ResidualUNetGenerator(Generator):
    """A U-Net of residual blocks that works at a fraction of the drawing's resolution.

    Patches of pixels are unshuffled into channels, each level halves the resolution, and skip connections
    join levels of the same size. Hints enter at every level but the coarsest, so that a few of them affect
    the whole object. The output has four channels: a normal, whose length is the presence, and the
    confidence in its direction.

    Args:
        widths: channels of each level, from the finest to the coarsest.
        blocks: residual blocks of each level, in the encoder and again in the decoder.
        patch: side of the patches that are unshuffled into channels, a power of two.
        norm: norm of the residual blocks. Batch norm learns from fewer images. Without it, the samples of a
            batch do not affect one another in training.
        detail: side of the patches in the last two layers, which see the sketch again; a power of two, at
            most ``patch``. With 1, these two layers take as long as all others together.
        hint_levels: whether hints enter at these levels. If not, they enter with the sketch only, through the
            same number of weights, as an ablation.
        deblock: whether to average directions over a patch far from lines, except in training. Unshuffling
            leaves a faint grid, which lighting shows on smooth surfaces.
        mirror: whether to average the predictions for a drawing and its mirror image, except in training. It
            doubles the time.

    Raises:
        InputError: if ``widths`` and ``blocks`` differ in length, or a number is out of range.

    References:
        Shi et al. 2016, "Real-Time Single Image and Video Super-Resolution Using an Efficient Sub-Pixel
        Convolutional Neural Network" (unshuffling); Bae, Budvytis, Cipolla 2021, "Estimating and Exploiting
        the Aleatoric Uncertainty in Surface Normal Estimation" (confidence).
    """

    def __init__(
        self,
        widths: tuple[PositiveInt, ...] = (32, 64, 128, 192, 256),
        blocks: tuple[PositiveInt, ...] = (1, 1, 2, 2, 2),
        patch: PositiveInt = 2,
        norm: Literal["batch", "none"] = "none",
        detail: PositiveInt = 1,
        hint_levels: bool = True,
        deblock: bool = False,
        mirror: bool = False,
    ) -> None:
        super().__init__()
        check_ranges(self, self.built_with)
        check_levels(self, widths, blocks)
        if patch & (patch - 1) or detail & (detail - 1) or detail > patch:
            raise InputError(
                f"patch and detail of ResidualUNetGenerator are {patch} and {detail}; they must be powers of "
                "two, and detail at most patch."
            )
        self.patch = patch
        self.detail_patch = detail
        self.norm = norm
        self.hint_levels = hint_levels
        self.deblock = deblock
        self.mirror = mirror
        self.factor = patch * 2 ** (len(widths) - 1)
        pairs = list(pairwise(widths))
        self.stem = nn.Conv2d(5 * patch**2, widths[0], 3, padding=1)
        self.encoder = nn.ModuleList(
            [residual_blocks(*level, norm) for level in zip(widths, blocks, strict=True)]
        )
        self.downs = nn.ModuleList([nn.Conv2d(fine + 4, coarse, 2, 2) for fine, coarse in pairs])
        self.ups = nn.ModuleList([nn.ConvTranspose2d(coarse, fine, 2, 2) for fine, coarse in pairs])
        self.merges = nn.ModuleList([nn.Conv2d(2 * fine + 4, fine, 1) for fine, _ in pairs])
        self.decoder = nn.ModuleList(
            [residual_blocks(*level, norm) for level in zip(widths[:-1], blocks[:-1], strict=True)]
        )
        self.heads = nn.Conv2d(widths[0], _OUTPUTS * patch**2, 3, padding=1)
        self.detail = nn.Sequential(  # the layers, as named in checkpoints; the setting is `detail_patch`
            nn.Conv2d((_OUTPUTS + 5) * detail**2, _DETAIL, 3, padding=1),
            nn.SiLU(),
            nn.Conv2d(_DETAIL, _OUTPUTS * detail**2, 3, padding=1),
        )
        # Convolutions are fastest in this layout. Weights in another layout would be converted at each step.
        self.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # missing in torch's types

    def forward(self, condition: Tensor) -> Tensor:
        """Return (N, 4, H, W): normals whose length is the presence, and their confidence κ > 0.

        Args and Raises as `predict`.
        """
        return self.predict(condition).channels()

    def predict(self, condition: Tensor) -> Predictions:
        """Return directions, the logit of presence, and the confidence; all in float32.

        Args:
            condition: (N, 4, H, W) as `Generator.forward` takes it.

        Raises:
            InputError: if the sides are not multiples of ``patch`` × 2^(levels - 1), or if batch norm in
                training has only one value per channel.
        """
        height, width = condition.shape[2:]
        if height % self.factor or width % self.factor:
            raise InputError(
                f"this generator needs sides that are multiples of {self.factor}, "
                f"not {height} × {width} pixels."
            )
        if self.training and self.norm == "batch" and len(condition) * height * width == self.factor**2:
            raise InputError(
                f"batch norm cannot learn from one picture of {height} × {width} pixels, of which one pixel "
                "is left at the coarsest level; use batches of 2 or more, or norm: none."
            )
        if self.training or not self.mirror:
            return self._predict(condition)
        return _mean_of_mirrored(self._predict(torch.cat([condition, _mirror_condition(condition)])))

    def _predict(self, condition: Tensor) -> Predictions:
        """Return the predictions of the network itself, without mirroring."""
        where = condition[:, 3:]
        # Hints get the memory layout of the features, because concatenation copies tensors of another layout.
        hints = torch.cat([condition[:, :3] * where, where], dim=1).contiguous(
            memory_format=torch.channels_last
        )
        # Ink is 1, and paper 0 like the padding. Where a hint replaces the sketch, it counts as paper.
        ink = (1 - condition[:, :1]) / 2 * (1 - where)
        ink_and_hints = torch.cat([ink, hints], dim=1).contiguous(memory_format=torch.channels_last)
        features = F.silu(self._body(ink_and_hints, hints))
        coarse = F.pixel_shuffle(_float32_output(self.heads, features), self.patch // self.detail_patch)
        details = _float32_output(self._details, coarse, ink_and_hints)
        heads = F.pixel_shuffle(coarse + details, self.detail_patch)
        direction, presence = F.normalize(heads[:, :3], dim=1, eps=1e-6), heads[:, 3:4]
        # Not in training: it has no weights, and takes long.
        if self.deblock and self.patch > 1 and not self.training:
            direction = _deblocked(direction, presence, ink.float(), self.patch)
        return Predictions(direction, presence, 1.01 + F.elu(heads[:, 4:]))  # so that κ > 0.01

    def _details(self, coarse: Tensor, ink_and_hints: Tensor) -> Tensor:
        """Return the output of the last two layers, which see the coarse output and the sketch's patches."""
        first = self.detail[0]
        assert isinstance(first, nn.Conv2d)
        # A sum of two convolutions in place of one of both, which would have to be concatenated.
        of_coarse, of_sketch = first.weight.tensor_split([coarse.shape[1]], dim=1)
        seen = F.conv2d(coarse, of_coarse, first.bias, padding=1)
        seen = seen + convolve_patches(ink_and_hints, of_sketch, None, self.detail_patch)
        details: Tensor = self.detail[1:](seen)
        return details

    def _body(self, ink_and_hints: Tensor, hints: Tensor) -> Tensor:
        """Return features (N, widths[0], H / patch, W / patch)."""
        halvings = self.patch.bit_length() - 1
        # The levels of the network: those finer than a patch are left out.
        pyramid = [hints, *hint_pyramid(hints, halvings + len(self.downs) - 1)][halvings:]
        if not self.hint_levels:
            pyramid = [torch.zeros_like(level) for level in pyramid]
        features: Tensor = convolve_patches(ink_and_hints, self.stem.weight, self.stem.bias, self.patch)
        skips = []
        for blocks, down, level in zip(self.encoder, self.downs, pyramid, strict=False):
            features = blocks(features)
            skips.append(features)
            features = down(torch.cat([features, level], dim=1))
        features = self.encoder[-1](features)
        for i in reversed(range(len(self.ups))):
            features = self.merges[i](torch.cat([self.ups[i](features), skips[i], pyramid[i]], dim=1))
            features = self.decoder[i](features)
        return features


def convolve_patches(pixels: Tensor, weight: Tensor, bias: Tensor | None, patch: int) -> Tensor:
    """Return a 3 × 3 convolution of the patches of (N, C, H, W), unshuffled into channels.

    A convolution with a stride does the same on the pixels. In ONNX Runtime it is faster, because unshuffling
    copies all pixels in an order that is slow to read.

    Args:
        pixels: (N, C, H, W).
        weight: (O, C · patch², 3, 3).
        bias: (O,), or None.
        patch: side of the patches.
    """
    return F.conv2d(pixels, F.pixel_shuffle(weight, patch), bias, stride=patch, padding=patch)


def _deblocked(direction: Tensor, presence: Tensor, ink: Tensor, patch: int) -> Tensor:
    """Return unit normals (N, 3, H, W) without the grid of patches, except near lines.

    Args:
        direction: (N, 3, H, W) unit normals.
        presence: (N, 1, H, W) logit of presence; directions off the object count for little.
        ink: (N, 1, H, W), 1 on lines, 0 on paper.
        patch: an even number of pixels.
    """
    # The mean over a patch removes everything that repeats from patch to patch. It is shifted by half a
    # pixel, because a patch has no middle pixel; the mean of two neighbours shifts it back.
    weighted = direction * torch.sigmoid(presence).clamp(min=1e-3)
    mean = F.avg_pool2d(F.avg_pool2d(weighted, patch, 1, patch // 2, count_include_pad=False), 2, 1)
    # Normals jump at lines: leave them within a pixel of a line, and average fully from four pixels on.
    near = F.avg_pool2d(F.max_pool2d(ink, 5, 1, 2), 3, 1, 1, count_include_pad=False)
    # torch.lerp becomes several steps in an ONNX file.
    return F.normalize(mean + near * (weighted - mean), dim=1, eps=1e-6)


def hint_pyramid(hints: Tensor, levels: int) -> list[Tensor]:
    """Return hints at ``levels`` lower resolutions, tensors (N, 4, H / 2^l, W / 2^l) for l from 1.

    Each cell holds the mean of the hint normals in it, and 1 if it has any, else 0. At full resolution a
    convolution sees a hint within three pixels, and at the fifth level within a hundred.

    Args:
        hints: (N, 4, H, W), the normals at the hints, and 1 where there is one.
        levels: number of halvings, which the sides must allow.

    Example:
        >>> hints = torch.zeros(1, 4, 4, 4)
        >>> hints[0, :, 0, 1] = torch.tensor([0.0, 0.0, 1.0, 1.0])
        >>> [level[0, 2].tolist() for level in hint_pyramid(hints, 2)]
        [[[1.0, 0.0], [0.0, 0.0]], [[1.0]]]
    """
    total, pyramid = hints, []
    for _ in range(levels):
        total = 4 * F.avg_pool2d(total, 2)
        count = total[:, 3:]
        pyramid.append(torch.cat([total[:, :3] / count.clamp(min=1), count.clamp(max=1)], dim=1))
    return pyramid


def _mirror_condition(condition: Tensor) -> Tensor:
    """Return a generator's input (N, 4, H, W) for the mirror image of its drawing."""
    normals, where = condition[:, :3], condition[:, 3:]
    # Where there is no hint, these channels hold the sketch, whose values are not directions.
    return torch.cat([torch.where(where > 0.5, _flip_x(normals), normals), where], dim=1).flip(3)


def _mean_of_mirrored(preds: Predictions) -> Predictions:
    """Average the predictions for drawings with those for their mirror images.

    Directions are weighted by their confidence, if the network predicts one.

    Args:
        preds: predictions for N drawings, then for their mirror images; directions (2 N, 3, H, W).

    Returns:
        The predictions of the first N drawings, each averaged with its mirror image.
    """
    direction, presence, confidence = preds
    # A trace would record len() as a constant, and ONNX's exporter has no chunk; hence shape and slices.
    count = direction.shape[0] // 2
    here, there = direction[:count], _flip_x(direction[count:].flip(3))
    if confidence is not None:
        sure, mirrored = confidence[:count], confidence[count:].flip(3)
        here, there, confidence = here * sure, there * mirrored, (sure + mirrored) / 2
    if presence is not None:
        presence = (presence[:count] + presence[count:].flip(3)) / 2
    return Predictions(F.normalize(here + there, dim=1, eps=1e-6), presence, confidence)


def _flip_x(normals: Tensor) -> Tensor:
    """Return normals (N, 3, H, W) with x negated."""
    return torch.cat([-normals[:, :1], normals[:, 1:]], dim=1)


def _float32_output(layer: Callable[..., Tensor], *features: Tensor) -> Tensor:
    """Apply a layer to features (N, C, H, W) in float32, even under autocast.

    In bfloat16, logits near 5 are multiples of 0.03.
    """
    kind = features[0].device.type
    if not torch.is_autocast_enabled(kind):
        return layer(*features).float()  # the whole network may be bfloat16
    with torch.autocast(kind, enabled=False):
        return _float32_output(layer, *(each.float() for each in features))
