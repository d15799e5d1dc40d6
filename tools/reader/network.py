"""The reader's network: a U-Net with a trunk that sees all of the page, small enough for a core."""

import torch
from torch import Tensor, nn
from torch.nn import functional

WIDTHS = (32, 64, 96, 128)
BLOCKS = (1, 2, 2, 3)
FOLD = 4
OUTPUTS = 4
"""Ink, presence, and x and y of the way to the object's middle."""


class Block(nn.Module):
    """Two convolutions beside a short cut."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True),
            nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width),
        )  # fmt: skip

    def forward(self, x: Tensor) -> Tensor:
        """Return features of the same shape."""
        return functional.relu(x + self.body(x))


class Page(nn.Module):
    """Adds to each place what the page as a whole tells."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.mix = nn.Sequential(nn.Linear(2 * width, width), nn.ReLU(inplace=True), nn.Linear(width, width))

    def forward(self, x: Tensor) -> Tensor:
        """Return features of the same shape."""
        told = self.mix(torch.cat([x.mean((2, 3)), x.amax((2, 3))], 1))
        return x + told[:, :, None, None]


class Reader(nn.Module):
    """Takes pictures (N, 3, H, W) in [0, 1], BGR, H and W multiples of 32; returns (N, 4, H, W)."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Sequential(
            nn.Conv2d(3, 8, 3, padding=1, bias=False), nn.BatchNorm2d(8), nn.ReLU(inplace=True)
        )
        self.fold = nn.Sequential(
            nn.PixelUnshuffle(FOLD),
            nn.Conv2d(8 * FOLD**2, WIDTHS[0], 1, bias=False),
            nn.BatchNorm2d(WIDTHS[0]),
            nn.ReLU(inplace=True),
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
            parts = [Block(width) for _ in range(blocks)]
            if level >= 2:
                parts.insert(1, Page(width))
            self.down.append(nn.Sequential(*parts))
            if level < len(WIDTHS) - 1:
                self.leave.append(nn.Conv2d(WIDTHS[level + 1], width, 1))
                self.up.append(Block(width))
        self.unfold = nn.Sequential(nn.Conv2d(WIDTHS[0], 12 * FOLD**2, 1), nn.PixelShuffle(FOLD))
        self.gate = nn.Conv2d(WIDTHS[0], 8, 1)  # whether lines are dark or light here
        nn.init.zeros_(self.gate.weight)
        nn.init.zeros_(self.gate.bias)
        self.last = nn.Conv2d(12 + 8, 2, 3, padding=1)
        self.ways = nn.Conv2d(WIDTHS[0], 2, 1)

    def forward(self, picture: Tensor) -> Tensor:
        """Return ink and presence as logits, then the way to the middle."""
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
        return torch.cat([self.last(torch.cat([self.unfold(x), fine * (1 + gate)], 1)), ways], 1)
