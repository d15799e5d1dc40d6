"""How the sketch and its hints become what the networks see."""

import torch
from torch import Tensor

__all__ = ["make_condition", "paste_hints"]


def make_condition(sketch: Tensor, hints: Tensor) -> Tensor:
    """Return the input of the networks, (N, 4, H, W).

    The sketch is turned into colours in [-1, 1], paper white (1) and ink black (-1); at the hints, their
    normals are painted over it; the mask of the hints follows as the fourth channel.

    Args:
        sketch: (N, 1, H, W) in [0, 1], ink 1.
        hints: (N, 4, H, W), normals at the hints and where they are.

    References:
        Su et al. 2018, Fig. 2; He et al. 2021, 3.2 ("a four-dimensional input").
    """
    normals, where = hints[:, :3], hints[:, 3:]
    painted = torch.where(where > 0.5, normals, 1 - 2 * sketch)
    return torch.cat([painted, where], dim=1)


def paste_hints(preds: Tensor, hints: Tensor) -> Tensor:
    """Return painted normals (N, 3, H, W) with the hinted ones in place (He et al. 2021, section 3)."""
    normals, where = hints[:, :3], hints[:, 3:]
    return torch.where(where > 0.5, normals, preds)
