"""Hints at every scale, so that a point reaches its neighbourhood within a few layers."""

import torch
import torch.nn.functional as F
from torch import Tensor

__all__ = ["hint_pyramid"]


def hint_pyramid(hints: Tensor, levels: int) -> list[Tensor]:
    """Return the hints halved again and again, ``levels`` tensors (N, 4, H / 2^l, W / 2^l), l from 1.

    A cell holds the mean of the hint normals in it, and 1 if there is any, else 0. A convolution sees a
    lone point of a picture of 256 pixels from three pixels around; at the fifth level from a hundred.

    Args:
        hints: (N, 4, H, W), normals at the hints and where they are.
        levels: how often to halve; the sides must allow it.

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
