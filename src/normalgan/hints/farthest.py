"""FarthestPointHints: points as far apart as possible."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.hints.base import HINT_SAMPLERS, HintSampler
from normalgan.ranges import Count


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class FarthestPointHints(HintSampler):
    """Sample ``count`` points: the first at random, each next one farthest from the previous ones.

    Distances are Euclidean in the picture. An object with fewer pixels than ``count`` gets a hint at each
    pixel.

    Args:
        count: number of points per sample.

    References:
        Eldar, Lindenbaum, Porat, Zeevi 1997, "The Farthest Point Strategy for Progressive Image Sampling".
    """

    count: Count = 15

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the normals' type; see `HintSampler.sample`."""
        samples, _, height, width = normal.shape
        on_object = mask.flatten(1) > 0.5
        random = torch.rand(on_object.shape, generator=rng, device=normal.device)
        farthest = float(height**2 + width**2)
        # More than any distance everywhere on the object, so that the first point is random.
        distance = torch.where(on_object, farthest * (1 + random), -torch.ones_like(random))
        pixels = torch.arange(height * width, device=normal.device)
        rows, columns = pixels // width, pixels % width
        where = torch.zeros_like(random)
        for _ in range(min(self.count, height * width)):
            best, chosen = distance.max(1, keepdim=True)
            where = where.scatter(1, chosen, torch.where(best > 0, 1.0, where.gather(1, chosen)))
            away = (rows - rows[chosen]).square() + (columns - columns[chosen]).square()
            distance = torch.minimum(distance, away.to(distance.dtype))
        return where.to(normal.dtype).view(samples, 1, height, width)
