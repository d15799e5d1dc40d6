"""Checks of a generator."""

from typing import cast

import torch
from torch import Tensor

from normalgan.models import Generator
from normalgan.models.base import check_generated, check_predictions
from normalgan.testing.conformance import Check, demand, held_to_contract, promised
from normalgan.testing.networks import given, network_checks
from normalgan.testing.settings import settings_checks

__all__ = ["generator_checks"]

_PREDICTED = "predict must return Predictions whose channels() are what forward returns, in float32"


def generator_checks(size: int = 64) -> list[Check[Generator]]:
    """Return the checks of a generator for pictures of a size, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Generator),  # type: ignore[type-abstract]
        Check("shape and type", lambda g: _shape(g, size), promised(Generator.forward)),
        Check("range", lambda g: _range(g, size), "normals lie in [-1, 1], a confidence above 0"),
        *network_checks(size, _answer, sees_normals=False, contract=promised(Generator.forward)),
        Check("predictions for the losses", lambda g: _predictions(g, size), _PREDICTED),
        Check("training in bfloat16", lambda g: _bfloat16(g, size), _PREDICTED),
    ]


def _answer(generator: Generator, condition: Tensor, _: Tensor) -> tuple[Tensor, ...]:
    return (_predict(generator, condition),)


def _predict(generator: Generator, condition: Tensor) -> Tensor:
    predicted = generator(condition)
    with held_to_contract():
        check_generated(generator, predicted, condition)
    return cast("Tensor", predicted)


@torch.no_grad()
def _shape(generator: Generator, size: int) -> None:
    predicted = _predict(generator.eval(), given(2, size)[0])
    did = f"returned {predicted.dtype} for a condition of torch.float32"
    demand(predicted.dtype == torch.float32, generator, did, "it must keep the type")


@torch.no_grad()
def _range(generator: Generator, size: int) -> None:
    for scale in (1.0, 100.0):  # the second drives it to its limits
        predicted = _predict(generator.eval(), scale * given(2, size)[0])
        normals, confidence = predicted[:, :3], predicted[:, 3:]
        demand(
            predicted.isfinite().all(),
            generator,
            "predicted values that are not finite",
            "its answer must be finite",
        )
        largest = float(normals.abs().max())
        asked = "each component must lie in [-1, 1], as by tanh"
        demand(largest <= 1 + 1e-5, generator, f"predicted a component of {largest:.3g}", asked)
        positive = bool((confidence > 0).all())
        demand(
            positive, generator, "predicted a confidence of 0 or less", "the fourth channel must be above 0"
        )


@torch.no_grad()
def _predictions(generator: Generator, size: int) -> None:
    condition = given(2, size)[0]
    preds = generator.eval().predict(condition)
    with held_to_contract():
        check_predictions(generator, preds, condition)
    channels, predicted = preds.channels(), _predict(generator, condition)
    same = channels.shape == predicted.shape and torch.allclose(channels, predicted, atol=1e-5)
    asked = "what is trained and what is predicted must be the same; override both or forward alone"
    demand(same, generator, "predicts otherwise than forward returns", asked)


def _bfloat16(generator: Generator, size: int) -> None:
    """Demand predictions in float32 and gradients under mixed precision, as on a GPU."""
    generator.train()
    generator.zero_grad()
    with torch.autocast("cpu", torch.bfloat16):
        preds = generator.predict(given(2, size)[0])
    for name, part in preds._asdict().items():
        if part is not None:
            did = f"predicts {name} in {part.dtype} under mixed precision"
            demand(part.dtype == torch.float32, generator, did, "what losses take must be torch.float32")
    torch.stack([part.square().mean() for part in preds if part is not None]).sum().backward()
    grads = [p.grad for p in generator.parameters() if p.grad is not None]
    moves = any(bool(grad.any()) for grad in grads) and all(bool(grad.isfinite().all()) for grad in grads)
    did = "has no finite gradient under mixed precision"
    demand(moves, generator, did, "it must be trainable in bfloat16; mind what saturates")
    generator.zero_grad()
