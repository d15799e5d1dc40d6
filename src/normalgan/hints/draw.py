"""Reproducible drawing of hints from a sampler, either for a whole batch or for each sample by its name."""

from collections.abc import Sequence

import torch
from torch import Tensor

from normalgan.contracts import class_name, refused
from normalgan.errors import InputError
from normalgan.hints.base import ErrorHintSampler, HintSampler
from normalgan.hints.encode import hints_at
from normalgan.seeds import derive_seed


def draw_hints(
    sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int, error: Tensor | None = None
) -> Tensor:
    """Return the hints (N, 4, H, W) that a sampler draws for a batch with a seed.

    Args:
        sampler: sampler that chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 outside the object.
        mask: (N, 1, H, W), 1 on the object.
        seed: seed of all randomness.
        error: (N, 1, H, W), error of the generator's hint-free prediction, for an `ErrorHintSampler`.

    Raises:
        InputError: if the sampler does not return a tensor of the mask's shape. Its values are not checked
            here, because that would wait for the device; `draw_hints_by_name` checks them in validation.
    """
    return hints_at(normal, _sampled(sampler, normal, mask, seed, error))


def _sampled(sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int, error: Tensor | None) -> Tensor:
    """Return a sampler's hint mask, (N, 1, H, W)."""
    rng = torch.Generator(device=normal.device).manual_seed(seed)
    if error is not None and isinstance(sampler, ErrorHintSampler):
        where = sampler.sample_by_error(error.to(normal.dtype), mask, rng)
    else:
        where = sampler.sample(normal, mask, rng)
    check_hint_shape(sampler, where, mask)
    return where


def check_hint_shape(sampler: HintSampler, where: object, mask: Tensor) -> None:
    """Raise `InputError` unless a sampler returned a tensor of the mask's shape, on its device."""
    if not isinstance(where, Tensor) or where.shape != mask.shape:
        raise refused(sampler, where, _asked(mask))
    if where.device != mask.device:
        raise InputError(
            f"{class_name(sampler)} gave hints on {where.device}; hints are on the device of the normals, "
            f"{mask.device}."
        )


def check_hint_values(sampler: HintSampler, where: Tensor, mask: Tensor) -> None:
    """Raise `InputError` if a sampler returned values other than 1 and 0, or a hint outside the object."""
    odd = where[(where != 0) & (where != 1)]
    if len(odd):
        raise InputError(
            f"{class_name(sampler)} gave hints with the value {float(odd[0]):g}; {_asked(mask)}."
        )
    off = int(((where == 1) & (mask < 0.5)).sum())
    if off:
        raise InputError(
            f"{class_name(sampler)} gave {off} hints off the object; hints must lie where mask is 1: "
            "elsewhere the true normal is zero."
        )


def _asked(mask: Tensor) -> str:
    return f"hints are a tensor {tuple(mask.shape)} here, 1 at a hinted pixel and 0 elsewhere"


def draw_hints_by_name(
    sampler: HintSampler,
    normal: Tensor,
    mask: Tensor,
    names: Sequence[str],
    seed: int,
    error: Tensor | None = None,
) -> Tensor:
    """Return the hints (N, 4, H, W) of named samples, independent of batch, process and device.

    Args:
        sampler: sampler that chooses the points.
        normal: (N, 3, H, W) true unit normals, 0 outside the object.
        mask: (N, 1, H, W), 1 on the object.
        names: names of the N samples.
        seed: seed of all randomness, combined with each name.
        error: as in `draw_hints`.

    Raises:
        InputError: if the sampler does not return a tensor of the mask's shape with 0 and 1 on the object
            and 0 elsewhere.
    """
    # Always on the CPU, because a GPU draws other numbers from the same seed.
    errors = [None] * len(names) if error is None else error.cpu().split(1)
    singles = zip(normal.cpu().split(1), mask.cpu().split(1), errors, names, strict=True)
    drawn = []
    for each, inside, wrong, name in singles:
        where = _sampled(sampler, each, inside, derive_seed("hints", seed, name), wrong)
        check_hint_values(sampler, where, inside)
        drawn.append(hints_at(each, where))
    return torch.cat(drawn).to(normal.device)
