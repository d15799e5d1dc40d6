"""Generator and Discriminator: base classes of the networks."""

import inspect
from abc import ABC, abstractmethod
from typing import Any, Self

import torch
from torch import Tensor, nn

from normalgan.contracts import class_name, describe, refused
from normalgan.errors import InputError
from normalgan.models.predictions import Predictions
from normalgan.registry import Registry

INPUT_CHANNELS = 4
"""Sketch as RGB with the hint normals pasted in, and the mask of the hints: the paper's "four-dimensional"
input, in the reading of Su et al. 2018, Fig. 2."""


class Network(nn.Module, ABC):
    """Base of all networks; stores constructor arguments for checkpoints."""

    built_with: dict[str, Any]
    """The constructor arguments by name, including defaults."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        """Record the arguments before a subclass changes them."""
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
    """Base class of networks that predict a normal map.

    A constructor argument named ``size`` receives the setting ``data.size``. A generator may use torch's
    global random state, because each training step seeds it.
    """

    @abstractmethod
    def forward(self, condition: Tensor) -> Tensor:
        """Return normals (N, 3, H, W) in [-1, 1], of any length; short vectors mean background.

        An optional fourth channel is the confidence κ > 0 of the direction.

        Args:
            condition: (N, 4, H, W): the sketch in [-1, 1] (ink -1) with hint normals pasted in, then the
                hint mask.
        """

    def predict(self, condition: Tensor) -> Predictions:
        """Return the predictions for the training losses; by default the output of `forward` in float32.

        Override this in a generator that predicts presence as a logit, which losses such as
        `AngularLikelihood` need. `forward` should then return ``self.predict(condition).channels()``.

        Args:
            condition: (N, 4, H, W), as for `forward`.

        Raises:
            InputError: if `forward` calls `predict` and the class does not override it.
        """
        if self.__dict__.get("_predicts"):
            raise InputError(
                f"{class_name(self)}.forward calls predict, which calls forward; override predict too."
            )
        self.__dict__["_predicts"] = True
        try:
            output = self(condition)
        finally:
            del self.__dict__["_predicts"]
        check_generated(self, output, condition)
        output = output.float()  # may be bfloat16 under autocast
        if output.shape[1] == 3:  # slicing three of three channels would cost a copy in the backward pass
            return Predictions(output)
        return Predictions(output[:, :3], confidence=output[:, 3:])


class Discriminator(Network):
    """Base class of discriminators, which distinguish predicted from true maps (critics in WGANs)."""

    @abstractmethod
    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        """Return a tuple of raw scores, one tensor of any shape (N, ...) per head; high scores mean true.

        All heads have equal weight.

        Args:
            condition: (N, 4, H, W), input of the generator.
            normal: (N, 3, H, W) true or predicted normals.
        """


GENERATORS: Registry[Generator] = Registry(Generator, "normalgan.generators")  # type: ignore[type-abstract]
DISCRIMINATORS: Registry[Discriminator] = Registry(Discriminator, "normalgan.discriminators")  # type: ignore[type-abstract]


def check_generated(generator: nn.Module, predicted: object, condition: Tensor) -> None:
    """Check that a generator returned normals of the size of the sketches, with or without confidence.

    Args:
        generator: generator to check.
        predicted: output of the generator, which should be (N, 3, H, W) or (N, 4, H, W).
        condition: (N, 4, H, W), input of the generator.

    Raises:
        InputError: if ``predicted`` is anything else.
    """
    count, _, height, width = condition.shape
    if not isinstance(predicted, Tensor) or predicted.ndim != 4 or len(predicted) != count:
        asked = f"a generator gives a tensor {(count, 3, height, width)} here, or one of 4 channels with the "
        raise refused(generator, predicted, asked + "confidence")
    channels = predicted.shape[1]
    if channels not in {3, 4}:
        raise InputError(
            f"{class_name(generator)} returns {channels} channels; a model has 3, or 4 with the confidence."
        )
    if predicted.shape[2:] != condition.shape[2:]:
        raise InputError(
            f"{class_name(generator)} returns {predicted.shape[3]} × {predicted.shape[2]} pixels for a "
            f"sketch of {width} × {height}; a map is as large as its sketch."
        )


def check_predictions(generator: nn.Module, preds: object, condition: Tensor) -> None:
    """Check that the losses accept the output of a generator's ``predict``.

    Raises:
        InputError: if they do not, or if the output has no gradient while gradients are enabled.
    """
    count, _, height, width = condition.shape
    name = f"{class_name(generator)}.predict"
    if not isinstance(preds, Predictions):
        raise InputError(f"{name} gave {describe(preds)}; it gives normalgan.models.predictions.Predictions.")
    for part, channels in (("direction", 3), ("presence", 1), ("confidence", 1)):
        value, wanted = getattr(preds, part), (count, channels, height, width)
        if value is None and part != "direction":
            continue
        if not isinstance(value, Tensor) or value.shape != wanted:
            raise InputError(f"{name} gave {describe(value)} as {part}; it is a tensor {wanted} here.")
    if torch.is_grad_enabled() and not preds.direction.requires_grad:
        raise InputError(
            f"{class_name(generator)} returns maps without a gradient; do not detach them, and "
            "give it parameters to learn."
        )


def check_scores(discriminator: nn.Module, scores: object, condition: Tensor) -> tuple[Tensor, ...]:
    """Return a discriminator's scores after checking them.

    Args:
        discriminator: discriminator to check.
        scores: output of the discriminator, which should be a tuple or list of tensors (N, …).
        condition: (N, 4, H, W), input of the discriminator.

    Raises:
        InputError: if ``scores`` is anything else.
    """
    asked = f"a discriminator gives a tuple of scores, a tensor ({len(condition)}, …) a head"
    # A bare tensor is iterable too, so its samples would be mistaken for heads.
    if not isinstance(scores, tuple | list) or not scores:
        raise refused(discriminator, scores, asked)
    for each in scores:
        if not isinstance(each, Tensor) or each.ndim < 1 or len(each) != len(condition):
            raise refused(discriminator, scores, asked)
    return tuple(scores)
