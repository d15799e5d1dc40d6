"""The input of the networks, made from sketch and hints."""

import torch
from torch import Tensor


def make_condition(sketch: Tensor, hints: Tensor) -> Tensor:
    """Return the input of the networks, (N, 4, H, W).

    The sketch becomes three channels in [-1, 1], with paper 1 and ink -1. At the hints, it is replaced by
    the hint normals. The hint mask is the fourth channel.

    Args:
        sketch: (N, 1, H, W) in [0, 1], ink 1.
        hints: (N, 4, H, W): hint normals and hint mask.

    References:
        Su et al. 2018, Fig. 2; He et al. 2021, 3.2 ("a four-dimensional input").
    """
    normals, where = hints[:, :3], hints[:, 3:]
    channels = torch.where(where > 0.5, normals, 1 - 2 * sketch)
    return torch.cat([channels, where], dim=1)


def paste_hints(preds: Tensor, hints: Tensor) -> Tensor:
    """Return predicted normals (N, 3, H, W) with the hints pasted in (He et al. 2021, section 3)."""
    normals, where = hints[:, :3], hints[:, 3:]
    return torch.where(where > 0.5, normals, preds)
