"""Drawing hints from a sampler, repeatably: for a batch as a whole, or for each sample by its name."""

from collections.abc import Sequence

import torch
from torch import Tensor

from normalgan.hints.base import HintSampler
from normalgan.hints.encode import hints_at
from normalgan.seeds import derive_seed


def draw_hints(sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int) -> Tensor:
    """Return the hints (N, 4, H, W) that a sampler gives a batch under a seed.

    Args:
        sampler: chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 off the object.
        mask: (N, 1, H, W), 1 on the object.
        seed: of all randomness.
    """
    rng = torch.Generator(device=normal.device).manual_seed(seed)
    return hints_at(normal, sampler.sample(normal, mask, rng))


def draw_hints_by_name(
    sampler: HintSampler, normal: Tensor, mask: Tensor, names: Sequence[str], seed: int
) -> Tensor:
    """Return the hints (N, 4, H, W) of samples by name: the same in whatever batch and process they come.

    Args:
        sampler: chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 off the object.
        mask: (N, 1, H, W), 1 on the object.
        names: of the samples, N of them.
        seed: another seed gives other hints.
    """
    singles = zip(normal.split(1), mask.split(1), names, strict=True)
    return torch.cat([draw_hints(sampler, n, m, derive_seed("hints", seed, name)) for n, m, name in singles])
