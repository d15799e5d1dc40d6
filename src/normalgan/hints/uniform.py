"""UniformHints: points chosen uniformly on the object, as in Sketch2Normal."""

import math
from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints.base import HINT_SAMPLERS, HintSampler
from normalgan.ranges import Count, UnitInterval


@HINT_SAMPLERS.register
@dataclass(frozen=True)
class UniformHints(HintSampler):
    """Sample a random number of points, uniformly on the object.

    After Su et al., "Interactive Sketch-Based Normal Map Generation with Deep Neural Networks" (I3D 2018),
    who place hints at random and do not publish their number. The number of points of `CurvatureHints`
    varies with size and surface, so give both samplers the same number to compare positions only. An
    object with fewer pixels than points gets a hint at each pixel.

    Args:
        minimum: minimum number of hints.
        maximum: maximum number of hints.
        none: fraction of samples without hints, so that a generator learns to work without them.
        numbers: distribution of the number of hints: ``even`` (uniform) or ``log`` (log-uniform, so that
            few hints are as likely as many).
    """

    minimum: Count = 10
    maximum: Count = 50
    none: UnitInterval = 0.0
    numbers: Literal["even", "log"] = "even"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.minimum > self.maximum:
            raise InputError(
                f"UniformHints was given minimum={self.minimum} and maximum={self.maximum}; "
                "use a minimum that is not larger."
            )
        if self.numbers == "log" and self.minimum < 1:
            raise InputError(
                f"UniformHints was given minimum={self.minimum}; with numbers: log it is 1 or more."
            )

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the normals' type; see `HintSampler.sample`.

        The hints of a sample depend on its own mask, its position in the batch, the batch shape and the
        state of ``rng``, but not on the other samples.
        """
        count = len(normal)
        device = normal.device
        numbers = self._draw_numbers(count, rng, device)
        if self.none > 0:
            numbers *= torch.rand((count, 1), generator=rng, device=device) >= self.none
        on_object = mask.flatten(1) > 0.5
        scores = torch.rand(on_object.shape, generator=rng, device=device)
        scores = scores.masked_fill(~on_object, -1.0)
        # Draw a fixed number of candidates and mask the surplus, so that no value has to leave the device.
        best, pixels = scores.topk(min(self.maximum, scores.shape[1]), dim=1)
        chosen = (torch.arange(best.shape[1], device=device) < numbers) & (best >= 0)
        where = torch.zeros_like(scores, dtype=normal.dtype).scatter_(1, pixels, chosen.to(normal.dtype))
        return where.view_as(mask)

    def _draw_numbers(self, count: int, rng: torch.Generator, device: torch.device) -> Tensor:
        if self.numbers == "even":
            return torch.randint(self.minimum, self.maximum + 1, (count, 1), generator=rng, device=device)
        span = math.log((self.maximum + 1) / self.minimum)
        shares = torch.rand((count, 1), generator=rng, device=device)
        return (self.minimum * torch.exp(span * shares)).long().clamp(max=self.maximum)
