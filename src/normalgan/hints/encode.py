"""Hints in the form that the networks expect."""

import torch
from torch import Tensor


def hints_at(normal: Tensor, where: Tensor) -> Tensor:
    """Return hints with the normals at the given pixels.

    Args:
        normal: (N, 3, H, W) unit normals.
        where: (N, 1, H, W), 1 at a hinted pixel and 0 elsewhere.

    Returns:
        (N, 4, H, W) of the normals' type: the normals at the hinted pixels, 0 elsewhere; then ``where``.

    Example:
        >>> normal = torch.tensor([0.0, 0.6, 0.8]).view(1, 3, 1, 1).expand(1, 3, 1, 2)
        >>> hints_at(normal, torch.tensor([1.0, 0.0]).view(1, 1, 1, 2))[0, :, 0]
        tensor([[0.0000, 0.0000],
                [0.6000, 0.0000],
                [0.8000, 0.0000],
                [1.0000, 0.0000]])
    """
    hinted = where > 0.5
    return torch.cat([torch.where(hinted, normal, 0.0), hinted.to(normal.dtype)], dim=1)
