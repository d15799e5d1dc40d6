"""Noise in hints, because people set normals only roughly."""

import math

import torch
from torch import Tensor

from normalgan.metrics import unit_vectors


def perturb_hints(hints: Tensor, degrees: float, seed: int) -> Tensor:
    """Return hints (N, 4, H, W) with each normal rotated at random, at the same positions.

    Each sample gets its own noise level, uniform between 0 and ``degrees``, so that a network learns both
    to follow exact hints and to distrust rough ones.

    Args:
        hints: unit normals at the hints, 0 elsewhere, and the hint mask.
        degrees: mean angle between true and rotated normals at the highest noise level.
        seed: random seed.
    """
    rng = torch.Generator(device=hints.device).manual_seed(seed)
    normals, where = hints[:, :3], hints[:, 3:]
    # For small angles, the angle is the length of a 2D standard normal vector, with mean √(π / 2).
    deviation = math.radians(degrees) / math.sqrt(math.pi / 2)
    levels = deviation * torch.rand((len(hints), 1, 1, 1), generator=rng, device=hints.device)
    push = levels * torch.randn(normals.shape, generator=rng, device=hints.device)
    along = (push * normals).sum(1, keepdim=True)
    return torch.cat([unit_vectors(normals + push - along * normals) * where, where], dim=1)
