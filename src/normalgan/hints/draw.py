"""Drawing hints from a sampler, repeatably: for a batch as a whole, or for each sample by its name."""

from collections.abc import Sequence

import torch
from torch import Tensor

from normalgan.hints.base import ErrorHintSampler, HintSampler
from normalgan.hints.encode import hints_at
from normalgan.seeds import derive_seed

__all__ = ["draw_hints", "draw_hints_by_name"]


def draw_hints(
    sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int, error: Tensor | None = None
) -> Tensor:
    """Return the hints (N, 4, H, W) that a sampler gives a batch under a seed.

    Args:
        sampler: chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 off the object.
        mask: (N, 1, H, W), 1 on the object.
        seed: of all randomness.
        error: (N, 1, H, W), for an `ErrorHintSampler`, of what the generator paints without hints.
    """
    rng = torch.Generator(device=normal.device).manual_seed(seed)
    if error is not None and isinstance(sampler, ErrorHintSampler):
        return hints_at(normal, sampler.sample_by_error(error.to(normal.dtype), mask, rng))
    return hints_at(normal, sampler.sample(normal, mask, rng))


def draw_hints_by_name(
    sampler: HintSampler,
    normal: Tensor,
    mask: Tensor,
    names: Sequence[str],
    seed: int,
    error: Tensor | None = None,
) -> Tensor:
    """Return the hints (N, 4, H, W) of samples by name: the same in whatever batch, process and device.

    Args:
        sampler: chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 off the object.
        mask: (N, 1, H, W), 1 on the object.
        names: of the samples, N of them.
        seed: another seed gives other hints.
        error: as in `draw_hints`.
    """
    # On the CPU, whatever the device: a GPU draws other numbers from the same seed.
    errors = [None] * len(names) if error is None else error.cpu().split(1)
    singles = zip(normal.cpu().split(1), mask.cpu().split(1), errors, names, strict=True)
    drawn = [draw_hints(sampler, n, m, derive_seed("hints", seed, name), e) for n, m, e, name in singles]
    return torch.cat(drawn).to(normal.device)
