"""Dart throwing on a grid of pixels, in all pictures of a batch at once."""

import math

import torch
from torch import Tensor


def throw_darts(candidates: Tensor, priority: Tensor, distance: float) -> Tensor:
    """Return a set of candidates, no two closer than a distance, to which no further candidate can be added.

    Darts are thrown in the order of their priority. A dart lands unless an earlier one lies too near. The
    loop visits only the darts that land, and each of these removes the candidates around it.

    Args:
        candidates: (N, H, W), True where a dart may land.
        priority: (N, H, W), 0 or more; the highest comes first.
        distance: minimum distance in pixels; two points at exactly this distance may both stay.

    Returns:
        (N, H, W), True where a dart landed.

    Example:
        >>> row = torch.ones(1, 1, 5, dtype=torch.bool)
        >>> throw_darts(row, torch.tensor([[[0.1, 0.9, 0.8, 0.2, 0.3]]]), 2.0)[0, 0].tolist()
        [False, True, False, False, True]
    """
    count, height, width = candidates.shape
    reach = math.ceil(distance) - 1  # pixels: a farther one is never too near
    rows, columns = _disk(distance, reach, candidates.device)
    # A frame around the picture, so that a disk over its edge is no special case.
    waiting = priority.new_full((count, height + 2 * reach, width + 2 * reach), -1.0)
    inside = (slice(None), slice(reach, reach + height), slice(reach, reach + width))
    waiting[inside] = torch.where(candidates, priority, waiting[inside])
    landed = torch.zeros_like(waiting, dtype=torch.bool)
    flat, flat_landed = waiting.view(count, -1), landed.view(count, -1)
    disk = rows * waiting.shape[2] + columns
    while True:
        best, place = flat.max(dim=1, keepdim=True)
        lands = best >= 0
        if not bool(lands.any()):
            return landed[inside]
        flat_landed.scatter_(1, place, flat_landed.gather(1, place) | lands)
        # In a finished picture the place of the disk does not matter: no candidate is left.
        centre = torch.where(lands, place, reach * (waiting.shape[2] + 1))
        flat.scatter_(1, centre + disk, -1.0)


def _disk(distance: float, reach: int, device: torch.device) -> tuple[Tensor, Tensor]:
    """Return the rows and columns, each (P,) and from -reach to reach, of pixels closer than a distance."""
    along = torch.arange(-reach, reach + 1, device=device)
    near = (along[:, None] ** 2 + along**2) < distance**2
    rows, columns = near.nonzero(as_tuple=True)
    return rows - reach, columns - reach
