"""Generator and Discriminator: the bases of the networks."""

from abc import ABC, abstractmethod

from torch import Tensor, nn

from normalgan.predictions import Predictions
from normalgan.registry import Registry

INPUT_CHANNELS = 4
"""Sketch as RGB with the hint normals painted in, and the mask of the hints: the paper's "four-dimensional"
input, in the reading of Su et al. 2018, Fig. 2."""


class Generator(nn.Module, ABC):
    """Base of the networks that paint a normal map."""

    @abstractmethod
    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W) in [-1, 1], of any length; short vectors mean: no object here.

        A fourth channel, if any, is the confidence κ > 0 in their direction.

        Args:
            condition: (N, 4, H, W), the sketch in [-1, 1] (ink -1) with hint normals painted in, then the
                mask of the hints.
        """

    def predict(self, condition: Tensor) -> Predictions:
        """Return what the losses take in training; by default what `forward` returns, in float32.

        A generator that knows the presence of an object as a logit overrides it, and returns
        ``self.predict(condition).channels()`` from `forward`: losses such as `AngularLikelihood` need it.

        Args:
            condition: (N, 4, H, W) as `forward` takes it.
        """
        output = self(condition).float()  # under autocast it may be bfloat16
        return Predictions(output[:, :3], confidence=output[:, 3:] if output.shape[1] > 3 else None)


class Discriminator(nn.Module, ABC):
    """Base of the networks that tell painted maps from true ones (critics, if Wasserstein)."""

    @abstractmethod
    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return the raw scores of each head, of any shape (N, ...); high means true.

        Heads count equally, whatever their number of elements.

        Args:
            condition: (N, 4, H, W) as the generator sees it.
            normal: (N, 3, H, W) true or painted.
        """


GENERATORS: Registry[Generator] = Registry(Generator, "normalgan.generators")  # type: ignore[type-abstract]
DISCRIMINATORS: Registry[Discriminator] = Registry(Discriminator, "normalgan.discriminators")  # type: ignore[type-abstract]
