"""Checks of an augmentation."""

import json
from typing import Any

import torch
from lightning.fabric.utilities import move_data_to_device
from torch import Tensor

from normalgan.batch import Batch
from normalgan.data.augmentation import BatchAugmentation, augmented
from normalgan.hints import hints_at
from normalgan.testing.conformance import (
    Check,
    demand,
    device_check,
    held_to_contract,
    seed_checks,
    untouched_check,
)
from normalgan.testing.pictures import batch

_SIZE = 64


def augmentation_checks() -> list[Check[BatchAugmentation]]:
    """Return the named checks of an augmentation, for ``pytest.mark.parametrize``."""
    return [
        Check("a whole batch", _whole, "it must return an augmented copy of the batch"),
        Check("values in their ranges", _ranges, "ink is 0 to 1, a mask 0 or 1, a normal of length 1 on it"),
        Check(
            "vectors rotated with their pixels",
            _turned,
            "normals and hints must be moved and rotated together",
        ),
        *seed_checks(lambda augmentation, seed: _tensors(augmentation(_given(), seed)), "seed"),
        untouched_check(lambda augmentation, given: augmentation(given, 3), _given),
        Check("settings for records", _described, "describe must return plain values for JSON"),
        device_check(
            lambda augmentation, device: _tensors(augmentation(move_data_to_device(_given(), device), 4))
        ),
    ]


def _given() -> Batch:
    """Return four named samples with a hint at every fourth pixel of the object."""
    made = batch(4, _SIZE)
    where = torch.zeros_like(made["mask"])
    where[..., ::4, ::4] = 1
    hints = hints_at(made["normal"], where * made["mask"])
    return {**made, "hints": hints, "name": [f"sample{i}" for i in range(4)]}


def _whole(augmentation: BatchAugmentation) -> None:
    given = _given()
    for one in (given, {k: v for k, v in given.items() if k != "hints"}):
        with held_to_contract():
            got = augmented(augmentation, one, 1)  # type: ignore[arg-type]
        for name, value in got.items():
            if isinstance(value, Tensor):
                wanted: Any = one[name]  # type: ignore[literal-required]
                same = value.shape == wanted.shape and value.dtype == wanted.dtype
                did = f"returned {name} as {value.dtype} {tuple(value.shape)}"
                demand(same, augmentation, did, f"it was {wanted.dtype} {tuple(wanted.shape)}")


def _ranges(augmentation: BatchAugmentation) -> None:
    for seed in range(3):
        got = augmentation(_given(), seed)
        sketch, normal, mask = got["sketch"], got["normal"], got["mask"]
        inside = bool(((sketch >= 0) & (sketch <= 1)).all())
        did = f"returned ink from {float(sketch.min()):.3g} to {float(sketch.max()):.3g}"
        demand(inside, augmentation, did, "ink is 0 to 1")
        binary = bool(((mask == 0) | (mask == 1)).all())
        demand(binary, augmentation, "returned a mask with values between 0 and 1", "mask values are 0 or 1")
        off = float((normal.norm(dim=1, keepdim=True) - mask).abs().max())
        did = f"returned normals with a length that is {off:.3g} off"
        demand(off < 0.01, augmentation, did, "the length must be 1 on the mask and 0 elsewhere")


def _turned(augmentation: BatchAugmentation) -> None:
    for seed in range(3):
        got = augmentation(_given(), seed)
        there = (got["hints"][:, 3:] > 0.5) & (got["mask"] > 0.5)
        cosine = (got["hints"][:, :3] * got["normal"]).sum(1, keepdim=True)[there]
        if not len(cosine):
            continue  # all objects were moved out of the picture
        degrees = torch.rad2deg(torch.acos(cosine.clamp(-1, 1)))
        off = float(degrees.median())
        did = f"left hints {off:.1f}° from the normals where they lie"
        demand(off < 10, augmentation, did, "their pixels and vectors must be moved and rotated together")
        # Normals along the outline point outwards, however the picture was rotated.
        soft = torch.nn.functional.avg_pool2d(got["mask"], 7, 1, 3)
        across = torch.stack(torch.gradient(soft[:, 0], dim=(2, 1)), dim=1) * torch.tensor([-1.0, 1.0]).view(
            1, 2, 1, 1
        )
        rim = (got["mask"] > 0.5) & (soft < 0.7)
        out = (across * got["normal"][:, :2]).sum(1, keepdim=True)[rim]
        share = float((out > 0).float().mean()) if len(out) else 1.0
        did = f"left {1 - share:.0%} of the normals along the outline pointing inward"
        demand(share > 0.8, augmentation, did, "vectors must be rotated or mirrored with the picture")


def _described(augmentation: BatchAugmentation) -> None:
    settings = augmentation.describe()
    again = json.loads(json.dumps(settings))
    demand(isinstance(again, dict), augmentation, f"describes itself as {settings!r}", "it must be a mapping")


def _tensors(batch: Batch) -> list[Tensor]:
    return [value for value in batch.values() if isinstance(value, Tensor)]
