"""Analytic scenes for the hint samplers: a sphere, and a beast of smoothly joined capsules."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

Points = NDArray[np.float64]

# Ends and radius of each capsule, in a frame of [-1, 1]: trunk, neck, head, four legs, tail.
CAPSULES = (
    ((-0.40, 0.05, 0.00), (0.35, 0.05, 0.00), 0.21),
    ((0.40, 0.15, 0.00), (0.58, 0.48, 0.00), 0.11),
    ((0.58, 0.50, 0.00), (0.80, 0.42, 0.00), 0.10),
    ((-0.45, -0.10, 0.12), (-0.50, -0.70, 0.12), 0.08),
    ((-0.32, -0.10, -0.12), (-0.22, -0.70, -0.12), 0.08),
    ((0.30, -0.10, 0.12), (0.26, -0.70, 0.12), 0.08),
    ((0.40, -0.10, -0.12), (0.52, -0.70, -0.12), 0.08),
    ((-0.55, 0.15, 0.00), (-0.80, -0.10, 0.00), 0.04),
)


def sphere(size: int, radius: float) -> tuple[Tensor, Tensor]:
    """Return normals (1, 3, H, W) and mask (1, 1, H, W) of an orthographic sphere; radius in pixels."""
    x, y = _grid(size)
    x, y = x * size / 2 / radius, y * size / 2 / radius
    inside = x**2 + y**2 < 1
    normal = np.stack([x, y, np.sqrt(np.clip(1 - x**2 - y**2, 0, None))]) * inside
    return torch.tensor(normal[None], dtype=torch.float32), torch.tensor(inside[None, None]).float()


def beast(size: int) -> tuple[Tensor, Tensor]:
    """Return normals (1, 3, H, W) and mask (1, 1, H, W) of a smooth quadruped, seen without perspective."""
    x, y = _grid(size)
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 1.0)], axis=-1)
    active = np.arange(len(points))
    for _ in range(60):
        step = _distance(points[active])
        points[active, 2] -= step
        active = active[(step > 1e-5) & (points[active, 2] > -1)]
    hit = points[:, 2] > -1
    surface, h = points[hit], 1e-4
    offsets = h * np.eye(3)
    gradient = np.stack([_distance(surface + o) - _distance(surface - o) for o in offsets], axis=-1)
    normal = np.zeros_like(points)
    normal[hit] = gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
    return (
        torch.tensor(normal.reshape(1, size, size, 3), dtype=torch.float32).permute(0, 3, 1, 2).contiguous(),
        torch.tensor(hit.reshape(1, 1, size, size)).float(),
    )


def seeded(seed: int = 0) -> torch.Generator:
    """Return a generator for a sampler."""
    return torch.Generator().manual_seed(seed)


def _grid(size: int) -> tuple[Points, Points]:
    """Return x to the right and y up at the pixel centres of the frame [-1, 1]²."""
    centres = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(centres, -centres)
    return x, y


def _distance(points: Points) -> Points:
    """Return the smooth minimum (sharpness 25) of the distances to the capsules."""
    total = np.zeros(len(points))
    for start, end, radius in CAPSULES:
        a, axis = np.array(start), np.array(end) - np.array(start)
        along = np.clip((points - a) @ axis / (axis @ axis), 0, 1)
        total += np.exp(-25 * (np.linalg.norm(points - a - along[:, None] * axis, axis=-1) - radius))
    return -np.log(np.maximum(total, 1e-300)) / 25
