"""Checks of a hint sampler."""

import torch
from torch import Tensor

from normalgan.hints import HintSampler
from normalgan.hints.draw import check_hint_shape, check_hint_values
from normalgan.testing.conformance import (
    Check,
    demand,
    device_check,
    held_to_contract,
    promised,
    seed_checks,
    untouched_check,
)
from normalgan.testing.pictures import pictures
from normalgan.testing.settings import settings_checks

_WHERE = promised(HintSampler.sample)


def hint_sampler_checks() -> list[Check[HintSampler]]:
    """Return the named checks of a hint sampler, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(HintSampler),  # type: ignore[type-abstract]
        Check("shape and type", _shape, _WHERE),
        Check("hints on the object", _on_object, _WHERE),
        Check("pictures without an object", _empty, "a picture without an object gets no hints"),
        Check("batches of other sizes", _sizes, "all sizes of pictures and batches must work"),
        *seed_checks(lambda sampler, seed: [_sample(sampler, *pictures(2), seed)], "rng"),
        Check("independent samples", _independent, "a sample must not depend on its neighbours"),
        untouched_check(lambda sampler, given: _sample(sampler, *given), lambda: pictures(2)),
        device_check(_on_device),
    ]


def _sample(sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int = 0) -> Tensor:
    rng = torch.Generator(normal.device).manual_seed(seed)
    where = sampler.sample(normal, mask, rng)
    with held_to_contract():
        check_hint_shape(sampler, where, mask)
    return where


def _shape(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    where = _sample(sampler, normal, mask)
    did = f"returned {where.dtype} for normals of {normal.dtype}"
    demand(where.dtype == normal.dtype, sampler, did, "it must return the dtype of the normals")


def _on_object(sampler: HintSampler) -> None:
    normal, mask = pictures(3)
    for seed in range(5):
        where = _sample(sampler, normal, mask, seed)
        with held_to_contract():
            check_hint_values(sampler, where, mask)


def _empty(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    normal[1], mask[1] = 0, 0
    given = int(_sample(sampler, normal, mask)[1].sum())
    did = f"gave {given} hints to a picture without an object"
    demand(given == 0, sampler, did, "it must return no hints and raise no error")


def _sizes(sampler: HintSampler) -> None:
    for count, height, width in ((1, 32, 32), (3, 24, 40), (5, 17, 16), (1, 1, 1)):
        _sample(sampler, *pictures(count, height, width))


def _independent(sampler: HintSampler) -> None:
    normal, mask = pictures(3)
    other_normal, other_mask = normal.clone(), mask.clone()
    other_normal[0], other_mask[0] = 0, 0
    for seed in range(5):
        one = _sample(sampler, normal, mask, seed)
        other = _sample(sampler, other_normal, other_mask, seed)
        did = "changed the hints of a sample when another sample of the batch was changed"
        asked = "a sample must not depend on its neighbours; use separate random numbers for each sample"
        demand(torch.equal(one[1:], other[1:]), sampler, did, asked)


def _on_device(sampler: HintSampler, device: torch.device) -> list[Tensor]:
    normal, mask = (part.to(device) for part in pictures(2))
    return [_sample(sampler, normal, mask)]
