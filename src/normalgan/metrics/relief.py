"""Relief: whether predicted normals turn away from the viewer as much as true ones."""

import torch
from torch import Tensor

from normalgan.metrics.functional import unit_vectors

__all__ = ["depth_difference", "total_variation"]


def depth_difference(preds: Tensor, target: Tensor) -> Tensor:
    """Return predicted minus true n_z, (N, 1, H, W); positive where the prediction is too flat.

    Args:
        preds: (N, 3, H, W) predicted normals, of any length.
        target: (N, 3, H, W) true unit normals.

    Example:
        >>> flat, slanted = torch.tensor([0.0, 0.0, 2.0]), torch.tensor([0.6, 0.0, 0.8])
        >>> depth_difference(flat.view(1, 3, 1, 1), slanted.view(1, 3, 1, 1)).item()
        0.19999998807907104
    """
    return unit_vectors(preds)[:, 2:3] - target[:, 2:3]


def total_variation(normals: Tensor, mask: Tensor) -> Tensor:
    """Return how much normals change from pixel to pixel, summed over the pairs of neighbours, (N,).

    A blurred map changes less than the truth, a noisy one more.

    Args:
        normals: (N, 3, H, W), scaled to unit length first.
        mask: (N, 1, H, W), 1 where pixels count; pairs with a pixel off it are left out.

    Example:
        >>> normals = torch.eye(3)[[0, 0, 1]].T.reshape(1, 3, 1, 3)  # right, right, up
        >>> total_variation(normals, torch.ones(1, 1, 1, 3)).item()
        1.4142135381698608
    """
    unit, inside = unit_vectors(normals), mask > 0.5
    sums = unit.new_zeros(len(unit))
    for axis in (2, 3):
        size = normals.shape[axis]
        here, there = (unit.narrow(axis, start, size - 1) for start in (0, 1))
        both = inside.narrow(axis, 0, size - 1) & inside.narrow(axis, 1, size - 1)
        lengths = (there - here).square().sum(1, keepdim=True).sqrt()
        sums = sums + torch.where(both, lengths, torch.zeros_like(lengths)).sum((1, 2, 3))
    return sums
