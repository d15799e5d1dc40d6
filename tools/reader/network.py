"""The reader's network: a U-Net whose trunk sees the whole page, small enough for one core."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn
from torch.nn import functional

WIDTHS = (32, 64, 96, 128)
BLOCKS = (1, 2, 2, 3)
FOLD = 4
OUTPUTS = 4
"""Ink, presence, and the x and y offsets to the object's centre."""


class Block(nn.Module):
    """Two convolutions with a skip connection."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True),
            nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width),
        )  # fmt: skip

    def forward(self, x: Tensor) -> Tensor:
        """Return features of the same shape."""
        features: Tensor = x + self.body(x)
        return functional.relu(features)


class Page(nn.Module):
    """Adds features of the whole page to each pixel."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.mix = nn.Sequential(nn.Linear(2 * width, width), nn.ReLU(inplace=True), nn.Linear(width, width))

    def forward(self, x: Tensor) -> Tensor:
        """Return features of the same shape."""
        told: Tensor = self.mix(torch.cat([x.mean((2, 3)), x.amax((2, 3))], 1))
        return x + told[:, :, None, None]


class Reader(nn.Module):
    """Takes pictures (N, 3, H, W) in [0, 1], BGR, H and W multiples of 32; returns (N, 4, H, W)."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Sequential(
            nn.Conv2d(3, 8, 3, padding=1, bias=False), nn.BatchNorm2d(8), nn.ReLU(inplace=True)
        )
        self.fold = nn.Sequential(
            nn.Conv2d(8, WIDTHS[0], FOLD, FOLD, bias=False), nn.BatchNorm2d(WIDTHS[0]), nn.ReLU(inplace=True)
        )
        self.down, self.up, self.enter, self.leave = (
            nn.ModuleList(),
            nn.ModuleList(),
            nn.ModuleList(),
            nn.ModuleList(),
        )
        for level, (width, blocks) in enumerate(zip(WIDTHS, BLOCKS, strict=True)):
            before = WIDTHS[level - 1] if level else width
            first = (
                nn.Sequential(
                    nn.Conv2d(before, width, 2, 2, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True)
                )
                if level
                else nn.Identity()
            )
            self.enter.append(first)
            parts: list[nn.Module] = [Block(width) for _ in range(blocks)]
            if level >= 2:
                parts.insert(1, Page(width))
            self.down.append(nn.Sequential(*parts))
            if level < len(WIDTHS) - 1:
                self.leave.append(nn.Conv2d(WIDTHS[level + 1], width, 1))
                self.up.append(Block(width))
        self.detail = nn.Sequential(nn.Conv2d(WIDTHS[0], 2 * FOLD**2, 3, padding=1), nn.PixelShuffle(FOLD))
        self.gate = nn.Conv2d(WIDTHS[0], 8, 1)  # whether lines are dark or light here
        nn.init.zeros_(self.gate.weight)
        assert self.gate.bias is not None
        nn.init.ones_(self.gate.bias)
        # With a stride of 1 this is a convolution. For two outputs, ONNX Runtime is much faster at it.
        self.lines = nn.ConvTranspose2d(8, 2, 3, padding=1, bias=False)
        self.ways = nn.Conv2d(WIDTHS[0], 2, 1)

    def forward(self, picture: Tensor) -> Tensor:
        """Return ink and presence as logits, then the offsets to the centre."""
        fine = self.stem(2 * picture - 1)
        x = self.fold(fine)
        kept = []
        for enter, down in zip(self.enter, self.down, strict=True):
            x = down(enter(x))
            kept.append(x)
        for level in range(len(WIDTHS) - 2, -1, -1):
            above = functional.interpolate(
                self.leave[level](x), scale_factor=2.0, mode="bilinear", align_corners=False
            )
            x = self.up[level](kept[level] + above)
        ways = functional.interpolate(
            self.ways(x), scale_factor=float(FOLD), mode="bilinear", align_corners=False
        )
        gate = functional.interpolate(self.gate(x), scale_factor=float(FOLD), mode="nearest")
        return torch.cat([self.detail(x) + self.lines(fine * gate), ways], 1)

    def load_onnx(self, path: Path) -> None:
        """Load the weights of an exported reader, whose normalisations are merged into convolutions."""
        stored = {i.name: torch.tensor(numpy_helper.to_array(i)) for i in onnx.load(path).graph.initializer}
        state = self.state_dict()
        self.load_state_dict({k: stored.get(k, v) for k, v in state.items()})
        rest = [stored[name] for name in stored if name not in state]
        pairs = list(self._normalised())
        if len(rest) != 2 * len(pairs):
            raise ValueError(f"{path} has {len(rest) // 2} convolutions, but this network has {len(pairs)}.")
        with torch.no_grad():
            for (conv, norm), weight, bias in zip(pairs, rest[::2], rest[1::2], strict=True):
                conv.weight.copy_(weight)
                norm.bias.copy_(bias)
                norm.running_var.fill_(1 - norm.eps)

    def merge(self) -> None:
        """Merge normalisations into the convolutions before them, as an export does."""
        with torch.no_grad():
            for conv, norm in self._normalised():
                scale = norm.weight / (norm.running_var + norm.eps).sqrt()
                conv.weight.mul_(scale[:, None, None, None])
                norm.bias.sub_(norm.running_mean * scale)
                norm.running_mean.zero_()
                norm.running_var.fill_(1 - norm.eps)
                norm.weight.fill_(1)

    def settle(self, pictures: list[Tensor]) -> None:
        """Give normalisations the mean and variance of pictures, without changing the network's output."""
        sums: dict[nn.Module, list[Tensor]] = {}
        pairs = list(self._normalised())
        hooks = [
            norm.register_forward_pre_hook(
                lambda module, given: sums.setdefault(module, []).append(
                    torch.stack([given[0].mean((0, 2, 3)), given[0].square().mean((0, 2, 3))])
                )
            )
            for _, norm in pairs
        ]
        self.eval()
        with torch.no_grad():
            for each in pictures:
                self(each)
            for _, norm in pairs:
                mean, square = torch.stack(sums[norm]).mean(0)
                spread = (square - mean**2).clamp(min=0)
                norm.running_mean.copy_(mean)
                norm.running_var.copy_(spread)
                norm.weight.copy_((spread + norm.eps).sqrt())
                norm.bias.add_(mean)
        for hook in hooks:
            hook.remove()
        self.train()

    def _normalised(self) -> Iterator[tuple[nn.Conv2d, Any]]:
        """Yield each convolution with its `BatchNorm2d`, in the order of execution."""
        for part in [
            self.stem,
            self.fold,
            *chain(*zip(self.enter, self.down, strict=True)),
            *reversed(self.up),
        ]:
            layers = [each for each in part.modules() if isinstance(each, nn.Conv2d | nn.BatchNorm2d)]
            yield from zip(layers[::2], layers[1::2], strict=True)
