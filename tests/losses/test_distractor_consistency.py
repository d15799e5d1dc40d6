import math

import torch
import torch.nn.functional as F

from normalgan.losses.distractor_consistency import (
    add_distractor_strokes,
    distractor_inconsistency,
    with_distractor_strokes,
)
from spheres import batch

SIZE = 128
REACH = SIZE // 12 + 2
"""Half of the longest stroke, and of its width."""


def test_strays_are_short_lie_on_the_object_and_take_no_line_away() -> None:
    torch.manual_seed(0)
    given = batch(64, SIZE)
    marked = add_distractor_strokes(given["sketch"], given["mask"], 0.5)
    added = (marked - given["sketch"]).flatten(1)
    assert added.min() >= 0
    assert added.max() == 1
    ink = added.sum(1)
    assert 8 <= (ink == 0).sum() <= 24  # of 64 a quarter
    assert ink.max() < 2 * (SIZE / 6 + 2) * 2.5  # two of the longest and widest, in pixels of 128
    beyond = F.max_pool2d(given["mask"], 2 * REACH + 1, stride=1, padding=REACH)
    assert not ((marked - given["sketch"]) * (1 - beyond)).any()
    assert torch.equal(add_distractor_strokes(given["sketch"], given["mask"], 0.0), given["sketch"])


def test_a_quarter_of_a_batch_is_marked_and_the_lines_stay() -> None:
    given = batch(8)
    marked = with_distractor_strokes(given["sketch"], given["mask"])
    assert len(marked) == 2
    assert (marked >= given["sketch"][:2]).all()
    assert (marked > given["sketch"][:2]).flatten(1).any(1).all()
    assert len(with_distractor_strokes(given["sketch"][:2], given["mask"][:2])) == 1


def test_unsteadiness_is_the_mean_angle_on_the_object_and_teaches_both_maps() -> None:
    given = batch(4)
    straight = torch.zeros_like(given["normal"])
    straight[:, 2] = 1
    turned = torch.zeros_like(straight[:2])
    turned[:, 2] = math.cos(0.2)
    turned[:, 0] = math.sin(0.2)
    off = 1 - given["mask"][:2]
    direction, marked = straight.requires_grad_(), (turned + 5 * off).requires_grad_()
    value = distractor_inconsistency(direction, marked, given["mask"])
    torch.testing.assert_close(value, torch.tensor(0.2))
    value.backward()
    for gradient in (direction.grad, marked.grad):
        assert gradient is not None
        assert not (gradient[:2] * off).any()
        assert (gradient[:2] * (1 - off)).any()
    assert direction.grad is not None
    assert not direction.grad[2:].any()  # those that are not painted twice
