"""Distractor consistency: meaningless strokes should not change the map."""

import math

import torch
from torch import Tensor

from normalgan.losses.angular_likelihood import smooth_angle

_SHARE_DISTRACTED = 1 / 4
"""Fraction of a batch that is predicted a second time with distractor strokes."""


def add_distractor_strokes(sketch: Tensor, mask: Tensor, share: float) -> Tensor:
    """Draw up to two short, straight, meaningless strokes on each object, like hatching or slips of the pen.

    The strokes are 1/30 to 1/6 of the side long and, at 256 pixels, 0.8 to 3 pixels wide.

    Args:
        sketch: (N, 1, H, W) in [0, 1], ink 1.
        mask: (N, 1, H, W), 1 on the object; strokes are centred there.
        share: probability of each of the two strokes.
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


def with_distractor_strokes(sketch: Tensor, mask: Tensor) -> Tensor:
    """Return the first quarter of the sketches (N, 1, H, W), at least one, with distractor strokes added."""
    count = max(round(len(sketch) * _SHARE_DISTRACTED), 1)
    return add_distractor_strokes(sketch[:count], mask[:count], 1.0)


def distractor_inconsistency(direction: Tensor, distracted: Tensor, mask: Tensor) -> Tensor:
    """Return the mean angle in radians between predictions with and without distractor strokes, a scalar.

    Gradients flow into both maps. With the stroke-free map detached, small networks lose the object's form.

    Args:
        direction: (N, 3, H, W) predicted unit normals.
        distracted: (M, 3, H, W) predictions for the first M sketches after distractor strokes were added.
        mask: (N, 1, H, W), 1 on the object.
    """
    count = len(distracted)
    some = mask[:count]
    return (smooth_angle(distracted, direction[:count]) * some).sum() / some.sum().clamp(min=1)
