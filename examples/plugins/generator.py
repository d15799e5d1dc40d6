"""A generator, which maps a condition (N, 4, H, W) to normals (N, 3, H, W)."""

import torch
from torch import Tensor, nn

from normalgan.models import GENERATORS, INPUT_CHANNELS, Generator
from normalgan.testing import check


@GENERATORS.register
class PlainGenerator(Generator):
    """A few convolutions at full size.

    Args:
        width: channels inside.
        layers: convolutions inside.
    """

    def __init__(self, width: int = 32, layers: int = 4) -> None:
        super().__init__()
        inside = [nn.Conv2d(width, width, 3, padding=1) for _ in range(layers)]
        self.body = nn.Sequential(nn.Conv2d(INPUT_CHANNELS, width, 3, padding=1), nn.ReLU())
        for layer in inside:
            self.body.extend([layer, nn.ReLU()])
        self.body.append(nn.Conv2d(width, 3, 3, padding=1))

    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W)."""
        return torch.tanh(self.body(condition))


if __name__ == "__main__":
    check(PlainGenerator(8, 1), size=32)
