"""Test pictures for the checks: dented ellipsoids at different positions and sizes, with exact maps."""

import torch
from torch import Tensor

from normalgan.batch import Batch


def pictures(count: int, height: int = 32, width: int = 32) -> tuple[Tensor, Tensor]:
    """Return normals (N, 3, H, W), 0 outside the object, and masks (N, 1, H, W) of N different objects.

    Each object is the upper half of an ellipsoid with a dent, so it has convex and concave regions.
    """
    y, x = torch.meshgrid(_centres(height).flip(0), _centres(width), indexing="ij")
    normals, masks = [], []
    for i in range(count):
        u = (x - 0.2 * (i % 3 - 1)) / (0.5 + 0.1 * (i % 4))
        v = (y + 0.1 * (i % 2)) / 0.7
        square = u**2 + v**2
        mask = (square < 1).float()
        dent = torch.exp(-square / 0.08)
        upright = (1 - square).clamp(min=1e-4).sqrt()
        normal = torch.stack([u * (1 - 3 * dent), v * (1 - 3 * dent), upright])
        normals.append(normal / normal.norm(dim=0) * mask)
        masks.append(mask[None])
    return torch.stack(normals), torch.stack(masks)


def batch(count: int, size: int) -> Batch:
    """Return a batch of such objects, with their outlines as sketches."""
    normal, mask = pictures(count, size, size)
    inside = -torch.nn.functional.max_pool2d(-mask, 3, 1, 1)
    return {"sketch": mask - inside, "normal": normal, "mask": mask}


def _centres(count: int) -> Tensor:
    return (torch.arange(count) + 0.5) / count * 2 - 1
