"""Noise in hints: a person pins a normal about right, not exactly."""

import math

import torch
from torch import Tensor

from normalgan.metrics import unit_vectors

__all__ = ["turn_hints"]


def turn_hints(hints: Tensor, degrees: float, seed: int) -> Tensor:
    """Return hints (N, 4, H, W) whose normals are each turned at random; where they are stays.

    A sample's hints are off by between nothing and ``degrees`` on average (a level a sample, evenly drawn),
    so that a network learns both to take a hint at its word and not to trust it blindly.

    Args:
        hints: unit normals at the hints, 0 elsewhere, and where they are.
        degrees: mean angle between true and turned normals of the worst sample.
        seed: of the randomness.
    """
    rng = torch.Generator(device=hints.device).manual_seed(seed)
    normals, where = hints[:, :3], hints[:, 3:]
    # The length of a plane's normal deviate, which the angle is for small ones, has a mean of √(π / 2).
    deviation = math.radians(degrees) / math.sqrt(math.pi / 2)
    levels = deviation * torch.rand((len(hints), 1, 1, 1), generator=rng, device=hints.device)
    push = levels * torch.randn(normals.shape, generator=rng, device=hints.device)
    along = (push * normals).sum(1, keepdim=True)
    return torch.cat([unit_vectors(normals + push - along * normals) * where, where], dim=1)
