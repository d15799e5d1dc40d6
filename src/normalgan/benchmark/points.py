"""Points: the test hints, uniform on the object and equal for all methods."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from normalgan.seeds import derive_seed

__all__ = ["hint_order", "hint_points"]


def hint_order(mask: Tensor, name: str, seed: int, most: int) -> Tensor:
    """Return the flat indices of a sample's hinted pixels, the first hint first.

    The first five of fifty hints are the five hints.

    Args:
        mask: (1, H, W), 1 on the object.
        name: of the sample; another one has other points.
        seed: another seed gives other points.
        most: how many, if the object has as many pixels.
    """
    pixels = torch.nonzero(mask.flatten() > 0.5).flatten()
    order = np.random.default_rng(derive_seed("benchmark", seed, name)).permutation(len(pixels))
    return pixels[torch.from_numpy(order[:most]).to(pixels.device)]


def hint_points(mask: Tensor, names: Sequence[str], seed: int, count: int) -> Tensor:
    """Return the hint mask of a batch, (N, 1, H, W) of the mask's type, 1 at a hint.

    Args:
        mask: (N, 1, H, W), 1 on the object.
        names: of the N samples.
        seed: of the points.
        count: hints of each sample; all of its pixels if it has fewer.
    """
    where = torch.zeros_like(mask)
    for sample, one, name in zip(where, mask, names, strict=True):
        sample.view(-1)[hint_order(one, name, seed, count)] = 1
    return where
