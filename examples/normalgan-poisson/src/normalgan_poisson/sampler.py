"""PoissonHints: points scattered evenly over the object, no two close together."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints import HintSampler
from normalgan_poisson.darts import throw_darts


@dataclass(frozen=True)
class PoissonHints(HintSampler):
    """Scatters points over the object evenly but at random, no two close together.

    It throws darts (Cook, "Stochastic Sampling in Computer Graphics", ACM Transactions on Graphics 5(1),
    1986) until no further point fits on the object. Larger distances are faster, because each point takes one
    step.

    Args:
        distance: minimum distance between two hints in pixels, at least 2.
        keep: share of the points that are kept, from 0 to 1; the rest are dropped at random.

    Raises:
        InputError: if a setting is out of range.
    """

    distance: float = 16.0
    keep: float = 1.0

    def __post_init__(self) -> None:
        if not 2 <= self.distance <= 256:
            raise InputError(f"PoissonHints was given distance={self.distance}; use 2 to 256 pixels.")
        if not 0 <= self.keep <= 1:
            raise InputError(f"PoissonHints was given keep={self.keep}; it is a share, from 0 to 1.")

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the normals' type; see `HintSampler.sample`.

        A sample's hints depend only on its own mask, its place in the batch, the shape of the batch and the
        state of ``rng``, never on the contents of other samples.
        """
        # One draw for the whole batch, with a length that its contents do not change: samples stay
        # independent.
        priority, fate = torch.rand((2, *mask.shape), generator=rng, device=normal.device)
        points = throw_darts(mask[:, 0] > 0.5, priority[:, 0], self.distance)[:, None]
        return (points & (fate < self.keep)).to(normal.dtype)
