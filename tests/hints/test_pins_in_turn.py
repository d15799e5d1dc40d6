"""Pins in turn: each lies in the region where the prediction with those before it is most wrong."""

import torch
from torch import Tensor

from normalgan.hints.pins_in_turn import MOST_TURNS, pin_in_turn

SIDE = 64
SAMPLES = 12


def scene() -> tuple[Tensor, Tensor]:
    """Return true normals that face the viewer and their masks: an object of 48 × 48 pixels."""
    mask = torch.zeros(SAMPLES, 1, SIDE, SIDE)
    mask[..., 8:56, 8:56] = 1
    return torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1) * mask, mask


def wrong_in_two_places(hints: Tensor) -> Tensor:
    """Predict a small patch a little wrong and a large one very wrong, each until a pin lies in it."""
    normal, _ = scene()
    for rows, columns, wrong in [((10, 26), (10, 26), [0.8, 0, 0.6]), ((30, 54), (30, 54), [1.0, 0, 0])]:
        place = (..., slice(*rows), slice(*columns))
        pinned = hints[(slice(None), slice(3, 4), *place[1:])].flatten(1).amax(1) > 0
        for sample in range(SAMPLES):
            if not pinned[sample]:
                normal[(sample, *place)] = torch.tensor(wrong).view(3, 1, 1)
    return normal


def test_each_pin_mends_the_worst_region_that_is_left() -> None:
    normal, mask = scene()
    none = torch.zeros(SAMPLES, 4, SIDE, SIDE)
    pinned = pin_in_turn(wrong_in_two_places, normal, mask, none, seed=3)
    counts = pinned[:, 3].flatten(1).sum(1)
    assert set(counts.tolist()) == set(range(MOST_TURNS + 1))
    large = pinned[:, 3, 30:54, 30:54].flatten(1).sum(1)
    small = pinned[:, 3, 10:26, 10:26].flatten(1).sum(1)
    assert ((large > 0) == (counts > 0)).all()
    assert ((small > 0) == (counts > 1)).all()
    assert (pinned[:, :3] == normal * pinned[:, 3:]).all()


def test_pins_lie_on_the_object_and_not_on_hints_that_are_there() -> None:
    normal, mask = scene()
    there = torch.cat([normal, mask], dim=1)
    there[:, :, 20, 20] = 0  # the only place that is left
    pinned = pin_in_turn(lambda hints: -normal, normal, mask, there, seed=3)
    assert (pinned == torch.cat([normal, mask], dim=1)).all(dim=(1, 2, 3)).any()
    assert (pinned[:, 3:] <= mask).all()
