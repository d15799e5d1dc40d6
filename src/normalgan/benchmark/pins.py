"""Pins: simulate a user who places one hint at a time after seeing the current map."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.methods import Method
from normalgan.hints import hints_at
from normalgan.inference.suggestion import suggest
from normalgan.metrics import angular_error, without_hints

Strategy = Literal["worst", "suggested"]
"""How the next pin is placed: at the largest error, which only an oracle knows, or as the studio suggests."""
STRATEGIES: tuple[Strategy, ...] = ("worst", "suggested")

_AROUND = 5  # window in pixels over which errors are averaged


def pin_one_by_one(method: Method, batch: Batch, strategy: Strategy, count: int) -> Tensor:
    """Return the summed angular error of N samples after 0, 1, … pins, and the number of pixels.

    Pixels that have a pin in the end are not counted, so that the pixels are the same for every number of
    pins. Each pin has the true normal.

    Returns:
        (N, count + 2), sums in degrees after each number of pins, followed by the number of pixels.
    """
    target, mask = batch["normal"], batch["mask"]
    where = torch.zeros_like(mask)
    angles = []
    for number in range(count + 1):
        predicted = method.predict(batch, hints_at(target, where) if number else None)
        angle = angular_error(predicted[:, :3], target)
        angles.append(angle)
        if number < count:
            where = torch.maximum(where, _next(predicted, angle, mask, where, strategy))
    inside = without_hints(mask, where) > 0.5
    sums = [torch.where(inside, angle, 0.0).double().sum((1, 2, 3)) for angle in angles]
    return torch.stack([*sums, inside.double().sum((1, 2, 3))], dim=1).cpu()


def pin_curve(sums: Sequence[Tensor]) -> list[float]:
    """Return the mean error in degrees after 0, 1, … pins, over all samples of `pin_one_by_one`."""
    total = torch.cat(list(sums)).sum(0)
    return [round(float(value), 4) for value in total[:-1] / total[-1]]


def _next(predicted: Tensor, angle: Tensor, mask: Tensor, where: Tensor, strategy: Strategy) -> Tensor:
    """Return the position of the next pin of each sample as a mask (N, 1, H, W)."""
    chosen = torch.zeros_like(mask)
    free = (mask > 0.5) & (where <= 0.5)
    if strategy == "worst":
        inside = mask.to(angle)
        seen = F.avg_pool2d(angle * inside, _AROUND, 1, _AROUND // 2)
        seen = seen / F.avg_pool2d(inside, _AROUND, 1, _AROUND // 2).clamp(min=1e-6)
        best, pixels = torch.where(free, seen, -1.0).flatten(1).max(1, keepdim=True)
        return chosen.flatten(1).scatter(1, pixels, (best >= 0).to(chosen)).view_as(mask)
    for i in range(len(mask)):
        row, column = _suggested(predicted[i], mask[i, 0] > 0.5, free[i, 0], where[i, 0])
        if free[i, 0, row, column]:
            chosen[i, 0, row, column] = 1
    return chosen


def _suggested(predicted: Tensor, inside: Tensor, free: Tensor, where: Tensor) -> tuple[int, int]:
    normals = F.normalize(predicted[:3], dim=0).permute(1, 2, 0).cpu().numpy()
    confidence = predicted[3].cpu().numpy() if len(predicted) > 3 else None
    taken = np.argwhere(where.cpu().numpy() > 0.5)[:, ::-1].astype(np.float32) + 0.5
    points = suggest(normals, inside.cpu().numpy(), confidence, taken, 1)
    if points:
        return int(points[0].y), int(points[0].x)
    at = torch.nonzero(free)
    return (int(at[0, 0]), int(at[0, 1])) if len(at) else (0, 0)
