"""PoissonHints: points scattered evenly over the object, no two close together."""

from dataclasses import dataclass

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.hints import HintSampler
from normalgan_poisson.darts import throw_darts


@dataclass(frozen=True)
class PoissonHints(HintSampler):
    """Scatter points over the object evenly but at random, none close to another.

    Dart throwing (Cook, "Stochastic Sampling in Computer Graphics", ACM Transactions on Graphics 5(1), 1986)
    until no dart is left: nowhere on the object would another point fit in. The larger the distance, the
    quicker it is, for it takes a step for each point.

    Args:
        distance: least distance between two hints in pixels, from 2 on.
        keep: share of the points that are kept, from 0 to 1; the rest is dropped at random.

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
        """Return where the hints are, (N, 1, H, W) of the normals' type; see `HintSampler.sample`.

        A sample's hints depend on its own mask, its place in the batch, the shape of the batch and the state
        of ``rng``, and on nothing else of the other samples.
        """
        # One draw for the whole batch, of the same length whatever is in it: samples stay apart.
        priority, fate = torch.rand((2, *mask.shape), generator=rng, device=normal.device)
        points = throw_darts(mask[:, 0] > 0.5, priority[:, 0], self.distance)[:, None]
        return (points & (fate < self.keep)).to(normal.dtype)
