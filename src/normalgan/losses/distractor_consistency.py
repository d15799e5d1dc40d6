"""Steadiness: strokes that say nothing of the form leave the map as it is."""

import math

import torch
from torch import Tensor

from normalgan.losses.angular_likelihood import smooth_angle

__all__ = ["SHARE_MARKED", "add_distractor_strokes", "distractor_inconsistency", "mark_some"]

SHARE_MARKED = 1 / 4
"""Of a batch, painted a second time with strokes that say nothing."""


def add_distractor_strokes(sketch: Tensor, mask: Tensor, share: float) -> Tensor:
    """Draw short straight strokes on the object that say nothing of its form, at most two a sketch.

    Hatching, spots and slips of the pen are such. They are 1/30 to 1/6 of the side long and 0.8 to 3 pixels
    of a sketch of 256 wide.

    Args:
        sketch: (N, 1, H, W) in [0, 1], ink 1.
        mask: (N, 1, H, W), 1 on the object, where their middles lie.
        share: probability of each of the two.
    """
    count, _, height, width = sketch.shape
    device = sketch.device
    places = torch.multinomial(mask.flatten(1) + 1e-9, 2, replacement=True)  # anywhere, if there is no object
    row = torch.arange(height, device=device).view(1, height, 1)
    column = torch.arange(width, device=device).view(1, 1, width)
    for place in places.unbind(1):
        drawn, turned, long, wide = torch.rand(4, count, 1, 1, device=device)
        up, right = torch.sin(math.pi * turned), torch.cos(math.pi * turned)
        down = row - (place // width)[:, None, None]
        across = column - (place % width)[:, None, None]
        half = width * (1 / 60 + (1 / 12 - 1 / 60) * long)
        along = across * right - down * up
        beyond = (along.abs() - half).clamp(min=0)
        away = torch.hypot(across * up + down * right, beyond)
        pen = (0.8 + 2.2 * wide) * width / 256
        ink = (pen / 2 + 0.5 - away).clamp(0, 1) * (drawn < share)
        sketch = torch.maximum(sketch, ink[:, None])
    return sketch


def mark_some(sketch: Tensor, mask: Tensor) -> Tensor:
    """Return the first quarter of sketches (N, 1, H, W), at least one, with strokes that say nothing."""
    count = max(round(len(sketch) * SHARE_MARKED), 1)
    return add_distractor_strokes(sketch[:count], mask[:count], 1.0)


def distractor_inconsistency(direction: Tensor, marked: Tensor, mask: Tensor) -> Tensor:
    """Return by how many radians strokes that say nothing turn the normals of objects, a scalar.

    Both maps learn from it, each towards the other: with that without strokes held, small networks unlearnt
    the form instead.

    Args:
        direction: (N, 3, H, W) painted unit normals.
        marked: (M, 3, H, W) those of the first M sketches with such strokes.
        mask: (N, 1, H, W), 1 on the object.
    """
    count = len(marked)
    some = mask[:count]
    return (smooth_angle(marked, direction[:count]) * some).sum() / some.sum().clamp(min=1)
