"""HintSampler: chooses the pixels at which the true normal is given."""

from abc import ABC, abstractmethod

import torch
from torch import Tensor

from normalgan.ranges import RangeChecked
from normalgan.registry import Registry


class HintSampler(RangeChecked, ABC):
    """Base class of hint samplers, which stand in for the designer in training and testing."""

    @abstractmethod
    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W): 1 at a hinted pixel, 0 elsewhere.

        Hints lie on the object. A sample may get no hints. Its hints must not depend on other samples of
        the batch.

        Args:
            normal: (N, 3, H, W) true unit normals in camera space, 0 outside the object.
            mask: (N, 1, H, W), 1 on the object.
            rng: source of all randomness, on the device of ``normal``.
        """


class ErrorHintSampler(HintSampler):
    """Base class of samplers that use the error of the generator's hint-free prediction."""

    @abstractmethod
    def sample_by_error(self, error: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask, (N, 1, H, W) of the error's type: 1 at a hinted pixel, 0 elsewhere.

        Args:
            error: (N, 1, H, W), error of the predicted normals, 0 or more.
            mask: (N, 1, H, W), 1 on the object.
            rng: source of all randomness, on the device of ``error``.
        """

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        """Return the hint mask for a prediction that faces the viewer everywhere.

        Training and testing call `sample_by_error`. This method is for uses without a generator, such as
        pictures of a sampler's hints.
        """
        return self.sample_by_error((1 - normal[:, 2:3]).clamp(min=0), mask, rng)


HINT_SAMPLERS: Registry[HintSampler] = Registry(HintSampler, "normalgan.hint_samplers")  # type: ignore[type-abstract]
