"""Pins set one at a time, as a person does: each where the last prediction is most wrong."""

from collections.abc import Callable

import torch
from torch import Tensor
from torch.nn import functional as F

from normalgan.hints.encode import hints_at
from normalgan.metrics import angular_error

MOST_TURNS = 3
"""Maximum number of pins added in turn, equal to the maximum number of clicks of Sofiiuk et al."""
_REGION = 1 / 8
"""Side of the averaging square for errors, as a fraction of the picture's side: about a limb's width."""


def pin_in_turn(
    predict: Callable[[Tensor], Tensor], normal: Tensor, mask: Tensor, hints: Tensor, seed: int
) -> Tensor:
    """Return hints (N, 4, H, W) with 0 to `MOST_TURNS` additional pins for each sample.

    Each pin is the true normal at the centre of the region with the largest error, predicted with all
    previous pins.

    Args:
        predict: function that returns normals (N, 3, H, W) of any length for hints (N, 4, H, W).
        normal: (N, 3, H, W) true unit normals, 0 outside the object.
        mask: (N, 1, H, W), 1 on the object.
        hints: (N, 4, H, W) existing hints.
        seed: seed for the random number of pins.

    References:
        Sofiiuk, Petrov, Konushin 2022, "Reviving Iterative Training with Mask Guidance for Interactive
        Segmentation", section 3.3.
    """
    rng = torch.Generator(device=normal.device).manual_seed(seed)
    numbers = torch.randint(0, MOST_TURNS + 1, (len(hints), 1, 1, 1), generator=rng, device=normal.device)
    reach = int(normal.shape[-1] * _REGION / 2)
    on_object = mask > 0.5
    for turn in range(int(numbers.max())):
        error = torch.where(on_object, angular_error(predict(hints), normal), 0.0)
        # The box filter is separable, so its cost grows with the side of the square, not with its area.
        rows = F.avg_pool2d(error, (2 * reach + 1, 1), stride=1, padding=(reach, 0))
        region = F.avg_pool2d(rows, (1, 2 * reach + 1), stride=1, padding=(0, reach))
        free = on_object & (hints[:, 3:] < 0.5) & (numbers > turn)
        worst = torch.where(free, region, -1.0).flatten(1).argmax(1, keepdim=True)
        chosen = torch.zeros_like(region).flatten(1).scatter(1, worst, 1.0).view_as(region)
        hints = hints + hints_at(normal, chosen * free).to(hints.dtype)
    return hints
