"""HintSampler: chooses the pixels at which the true normal is given away."""

from abc import ABC, abstractmethod

import torch
from torch import Tensor

from normalgan.registry import Registry


class HintSampler(ABC):
    """Base of the hint samplers, which play the designer in training and testing."""

    @abstractmethod
    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return where the hints are: (N, 1, H, W), 1 at a hinted pixel and 0 elsewhere.

        Hints lie on the object; a sample may get none.

        Args:
            normal: (N, 3, H, W) true unit normals in camera space, 0 off the object.
            mask: (N, 1, H, W), 1 on the object.
            rng: source of all randomness, on the device of ``normal``.
        """


HINT_SAMPLERS: Registry[HintSampler] = Registry(HintSampler, "normalgan.hint_samplers")  # type: ignore[type-abstract]
