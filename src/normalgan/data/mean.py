"""The mean normal map of a split, a baseline that sees no sketch."""

from collections.abc import Iterable

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.data.loading.items import decode
from normalgan.vectors import unit_vectors

__all__ = ["ENOUGH", "mean_of_maps"]

ENOUGH = 1024
"""Samples of an endless split that its mean is taken over; at each pixel its error is about 1/32."""


def mean_of_maps(batches: Iterable[Batch], size: int) -> Tensor:
    """Return the mean of the normal maps, (3, H, W) of unit length, 0 where no object ever is.

    Args:
        batches: all samples, each once.
        size: H and W.
    """
    total = torch.zeros(3, size, size, dtype=torch.float64)
    for batch in batches:
        total += decode(batch)["normal"].double().sum(dim=0)
    return unit_vectors(total[None])[0].float()
