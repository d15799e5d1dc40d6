"""Generator and Discriminator: the bases of the networks."""

import inspect
from abc import ABC, abstractmethod
from typing import Any, Self

from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.predictions import Predictions
from normalgan.registry import Registry

__all__ = [
    "DISCRIMINATORS",
    "GENERATORS",
    "INPUT_CHANNELS",
    "Discriminator",
    "Generator",
    "Network",
    "check_channels",
]

INPUT_CHANNELS = 4
"""Sketch as RGB with the hint normals painted in, and the mask of the hints: the paper's "four-dimensional"
input, in the reading of Su et al. 2018, Fig. 2."""


class Network(nn.Module, ABC):
    """Base of all networks: remembers what one was built with, so that a checkpoint can name it."""

    built_with: dict[str, Any]
    """The arguments it was built with, defaults among them, by name."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        """Note the arguments, before a subclass sees them."""
        network = super().__new__(cls)
        try:
            given = inspect.signature(cls.__init__).bind_partial(network, *args, **kwargs)
        except TypeError:  # __init__ says it better
            return network
        given.apply_defaults()
        _, *named = given.arguments.items()
        network.__dict__["built_with"] = dict(named)  # nn.Module is not set up yet
        return network


class Generator(Network):
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


def check_channels(generator: nn.Module, painted: Tensor) -> None:
    """Make sure that what a generator painted, (N, C, H, W), is normals, perhaps with their confidence.

    Raises:
        InputError: if it has other than 3 or 4 channels.
    """
    channels = painted.shape[1]
    if channels not in {3, 4}:
        raise InputError(
            f"{type(generator).__name__} paints {channels} channels; a model has 3, or 4 with the confidence."
        )


class Discriminator(Network):
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
