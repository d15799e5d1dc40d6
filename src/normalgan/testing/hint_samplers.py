"""Checks of a hint sampler."""

import torch
from torch import Tensor

from normalgan.hints import HintSampler
from normalgan.testing.conformance import (
    Check,
    class_name,
    demand,
    device_list,
    global_randomness_untouched,
)
from normalgan.testing.pictures import pictures
from normalgan.testing.settings import settings_checks

__all__ = ["hint_sampler_checks"]

_WHERE = "sample must return (N, 1, H, W), 1 at a hinted pixel and 0 elsewhere"


def hint_sampler_checks() -> list[Check[HintSampler]]:
    """Return the checks of a hint sampler, each with a name, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(HintSampler),  # type: ignore[type-abstract]
        Check("shape and type", _shape, _WHERE),
        Check("zeros and ones", _binary, _WHERE),
        Check("hints on the object", _on_object, _WHERE),
        Check("pictures without an object", _empty, "a picture without an object gets no hints"),
        Check("batches of other sizes", _sizes, "every size of picture and batch must do"),
        Check("the same hints under a seed", _seeded, "rng alone may decide"),
        Check("global randomness left alone", _no_global, "all randomness comes from rng"),
        Check("samples apart from one another", _independent, "a sample must not depend on its neighbours"),
        Check("arguments left as they are", _untouched, "the normals and the mask belong to the caller"),
        Check("every device there is", _devices, "tensors must be made on the device of normal"),
    ]


def _sample(sampler: HintSampler, normal: Tensor, mask: Tensor, seed: int = 0) -> Tensor:
    rng = torch.Generator(normal.device).manual_seed(seed)
    where = sampler.sample(normal, mask, rng)
    given = tuple(where.shape) if isinstance(where, Tensor) else class_name(where)
    wanted = (len(normal), 1, *normal.shape[2:])
    did = f"returned {given} for normals of {tuple(normal.shape)}"
    demand(given == wanted, sampler, did, f"it must return where the hints are, a tensor of {wanted}")
    return where


def _shape(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    where = _sample(sampler, normal, mask)
    did = f"returned {where.dtype} for normals of {normal.dtype}"
    demand(where.dtype == normal.dtype, sampler, did, "it must return the type of the normals")


def _binary(sampler: HintSampler) -> None:
    where = _sample(sampler, *pictures(3))
    strange = where[(where != 0) & (where != 1)]
    did = f"returned {strange[0].item() if len(strange) else ''}"
    demand(not len(strange), sampler, did, "a pixel has a hint, 1, or none, 0")


def _on_object(sampler: HintSampler) -> None:
    normal, mask = pictures(3)
    for seed in range(5):
        off = int((_sample(sampler, normal, mask, seed) * (1 - mask)).sum())
        did = f"gave {off} hints off the object"
        demand(off == 0, sampler, did, "hints must lie where mask is 1: elsewhere the true normal is zero")


def _empty(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    normal[1], mask[1] = 0, 0
    given = int(_sample(sampler, normal, mask)[1].sum())
    did = f"gave {given} hints to a picture without an object"
    demand(given == 0, sampler, did, "it must give none, and raise nothing")


def _sizes(sampler: HintSampler) -> None:
    for count, height, width in ((1, 32, 32), (3, 24, 40), (5, 17, 16), (1, 1, 1)):
        _sample(sampler, *pictures(count, height, width))


def _seeded(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    first = _sample(sampler, normal, mask, seed=1)
    torch.rand(3)  # another global state
    same = torch.equal(first, _sample(sampler, normal, mask, seed=1))
    did = "gave other hints under the same seed"
    demand(same, sampler, did, "all randomness must come from rng, so that a resumed run repeats")


def _no_global(sampler: HintSampler) -> None:
    with global_randomness_untouched(sampler):
        _sample(sampler, *pictures(2))


def _independent(sampler: HintSampler) -> None:
    normal, mask = pictures(3)
    other_normal, other_mask = normal.clone(), mask.clone()
    other_normal[0], other_mask[0] = 0, 0
    for seed in range(5):
        one = _sample(sampler, normal, mask, seed)
        other = _sample(sampler, other_normal, other_mask, seed)
        did = "changed the hints of a sample when another one of the batch was changed"
        asked = "a sample must not depend on its neighbours; give each a number or a generator of its own"
        demand(torch.equal(one[1:], other[1:]), sampler, did, asked)


def _untouched(sampler: HintSampler) -> None:
    normal, mask = pictures(2)
    kept = normal.clone(), mask.clone()
    _sample(sampler, normal, mask)
    same = torch.equal(normal, kept[0]) and torch.equal(mask, kept[1])
    demand(
        same, sampler, "changed the normals or the mask it was given", "they belong to the caller; copy them"
    )


def _devices(sampler: HintSampler) -> None:
    for device in device_list():
        normal, mask = (part.to(device) for part in pictures(2))
        where = _sample(sampler, normal, mask)
        did = f"returned a tensor on {where.device} for normals on {device}"
        demand(where.device == device, sampler, did, "it must stay on the device of the normals")
