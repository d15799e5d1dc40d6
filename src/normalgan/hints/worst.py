"""WorstErrorHints: points with the largest error, an oracle baseline for other samplers."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.hints.base import HINT_SAMPLERS, ErrorHintSampler
from normalgan.ranges import Count, NonNegative

_CROWDED = 1e4  # larger than any error


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class WorstErrorHints(ErrorHintSampler):
    """Sample points greedily where the generator's hint-free error is largest.

    Users do not know this error, so the sampler is an upper bound for other samplers. Points keep a minimum
    distance, because the neighbours of the worst pixel are nearly as wrong and one hint corrects them too.
    When no more points fit, the remaining ones go where the error is largest.

    Args:
        count: number of points per sample.
        spacing: minimum distance between points, in units of √(area of the object / ``count``).
    """

    count: Count = 15
    spacing: NonNegative = 0.5

    def sample_by_error(self, error: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the error's type; ``rng`` is not used."""
        samples, _, height, width = error.shape
        on_object = mask.flatten(1) > 0.5
        errors = error.flatten(1).float().clamp(min=0)  # float16 is too coarse for ranks
        area_per_point = on_object.sum(1, keepdim=True) / max(self.count, 1)
        reach = self.spacing * area_per_point.sqrt()
        # Free pixels rank by their errors, above pixels near a chosen point; chosen or outside pixels last.
        ranks = torch.where(on_object, errors, -math.inf)
        crowded = torch.where(on_object, errors - _CROWDED, -math.inf)
        pixels = torch.arange(height * width, device=error.device)
        rows, columns = pixels // width, pixels % width
        where = torch.zeros_like(errors)
        for _ in range(min(self.count, height * width)):
            best, chosen = ranks.max(1, keepdim=True)
            where = where.scatter(1, chosen, torch.where(best.isfinite(), 1.0, where.gather(1, chosen)))
            away = (rows - rows[chosen]).square() + (columns - columns[chosen]).square()
            near = away.to(reach.dtype) < reach.square()
            ranks = torch.where(near, torch.minimum(ranks, crowded), ranks).scatter(1, chosen, -math.inf)
        return where.to(error.dtype).view(samples, 1, height, width)
