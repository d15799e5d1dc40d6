"""Checks of generators and discriminators."""

import copy
from collections.abc import Callable
from typing import TypeVar, cast

import torch
from torch import Tensor, nn

from normalgan.models import Discriminator, Generator
from normalgan.models.base import check_generated, check_predictions, check_scores
from normalgan.models.condition import make_condition
from normalgan.testing.conformance import (
    Check,
    demand,
    device_check,
    held_to_contract,
    promised,
    untouched_check,
)
from normalgan.testing.pictures import batch
from normalgan.testing.settings import settings_checks

N = TypeVar("N", bound=nn.Module)
_Answer = Callable[[N, Tensor, Tensor], tuple[Tensor, ...]]
"""Function that runs a network on a condition (N, 4, H, W) and normals (N, 3, H, W) and checks its output."""

_PREDICTED = "predict must return Predictions whose channels() are what forward returns, in float32"
_CLOSE = 1e-4  # for float32 outputs that differ only in the order of additions


def generator_checks(size: int = 64) -> list[Check[Generator]]:
    """Return the checks of a generator, run with pictures of side ``size``, for pytest to parametrize."""
    return [
        *settings_checks(Generator),  # type: ignore[type-abstract]
        Check("shape and type", lambda g: _shape_of_map(g, size), promised(Generator.forward)),
        Check("range", lambda g: _range(g, size), "normals lie in [-1, 1], a confidence above 0"),
        *_network_checks(size, _answer, sees_normals=False, contract=promised(Generator.forward)),
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
def _shape_of_map(generator: Generator, size: int) -> None:
    predicted = _predict(generator.eval(), _given(2, size)[0])
    did = f"returned {predicted.dtype} for a condition of torch.float32"
    demand(predicted.dtype == torch.float32, generator, did, "it must keep the dtype")


@torch.no_grad()
def _range(generator: Generator, size: int) -> None:
    for scale in (1.0, 100.0):  # extreme values, to saturate the network
        predicted = _predict(generator.eval(), scale * _given(2, size)[0])
        normals, confidence = predicted[:, :3], predicted[:, 3:]
        demand(
            predicted.isfinite().all(),
            generator,
            "predicted values that are not finite",
            "its output must be finite",
        )
        largest = float(normals.abs().max())
        asked = "each component must be in [-1, 1], for example by tanh"
        demand(largest <= 1 + 1e-5, generator, f"predicted a component of {largest:.3g}", asked)
        positive = bool((confidence > 0).all())
        demand(
            positive, generator, "predicted a confidence of 0 or less", "the fourth channel must be above 0"
        )


@torch.no_grad()
def _predictions(generator: Generator, size: int) -> None:
    condition = _given(2, size)[0]
    preds = generator.eval().predict(condition)
    with held_to_contract():
        check_predictions(generator, preds, condition)
    channels, predicted = preds.channels(), _predict(generator, condition)
    same = channels.shape == predicted.shape and torch.allclose(channels, predicted, atol=1e-5)
    asked = "training and prediction must agree; override both, or only forward"
    demand(same, generator, "returns different values from predict and from forward", asked)


def _bfloat16(generator: Generator, size: int) -> None:
    """Check that predictions are float32 and gradients are finite under mixed precision, as on a GPU."""
    generator.train()
    generator.zero_grad()
    with torch.autocast("cpu", torch.bfloat16):
        preds = generator.predict(_given(2, size)[0])
    for name, part in preds._asdict().items():
        if part is not None:
            did = f"predicts {name} in {part.dtype} under mixed precision"
            demand(part.dtype == torch.float32, generator, did, "the input of losses must be torch.float32")
    torch.stack([part.square().mean() for part in preds if part is not None]).sum().backward()
    grads = [p.grad for p in generator.parameters() if p.grad is not None]
    moves = any(bool(grad.any()) for grad in grads) and all(bool(grad.isfinite().all()) for grad in grads)
    did = "has no finite gradient under mixed precision"
    demand(moves, generator, did, "it must be trainable in bfloat16; check for saturating functions")
    generator.zero_grad()


def discriminator_checks(size: int = 64) -> list[Check[Discriminator]]:
    """Return the checks of a discriminator, run with pictures of side ``size``, for pytest to parametrize."""
    contract = promised(Discriminator.forward)
    return [
        *settings_checks(Discriminator),  # type: ignore[type-abstract]
        Check("shape and type", lambda d: _shape_of_scores(d, size), contract),
        *_network_checks(size, _score, sees_normals=True, contract=contract),
    ]


def _score(discriminator: Discriminator, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
    scores = discriminator(condition, normal)
    with held_to_contract():
        return check_scores(discriminator, scores, condition)


@torch.no_grad()
def _shape_of_scores(discriminator: Discriminator, size: int) -> None:
    condition, normal = _given(2, size)
    for score in _score(discriminator.eval(), condition, normal):
        did = f"returned scores of {score.dtype} for normals of torch.float32"
        demand(score.dtype == torch.float32, discriminator, did, "it must keep the dtype")
        demand(
            score.isfinite().all(), discriminator, "gave a score that is not finite", "scores must be finite"
        )


def _network_checks(size: int, answer: _Answer[N], sees_normals: bool, contract: str) -> list[Check[N]]:
    """Return the checks shared by generators and discriminators.

    Args:
        size: side of the inputs in pixels.
        answer: function that runs the network and checks its output.
        sees_normals: whether the normals are an input.
        contract: requirement on ``forward``.
    """
    return [
        Check("batches of any size", lambda n: _batches(n, size, answer), contract),
        Check("learning", lambda n: _learning(n, size, answer), "gradients must flow"),
        Check("dependence on the input", lambda n: _looking(n, size, answer, sees_normals), contract),
        Check("repeating itself", lambda n: _repeating(n, size, answer), contract),
        Check("pictures apart", lambda n: _independence(n, size, answer), contract),
        untouched_check(lambda n, tensors: answer(n.eval(), *tensors), lambda: _given(2, size)),
        Check("a state that can be loaded", lambda n: _state(n, size, answer), "load_state_dict must work"),
        device_check(lambda n, device: _on_device(n, size, answer, device)),
    ]


def _given(count: int, size: int) -> tuple[Tensor, Tensor]:
    """Return a condition (N, 4, H, W) with a few hints, and the true normals (N, 3, H, W)."""
    pictures = batch(count, size)
    where = torch.zeros_like(pictures["mask"])
    where[..., size // 4 :: 5, size // 4 :: 7] = 1
    where = where * pictures["mask"]
    hints = torch.cat([pictures["normal"] * where, where], dim=1)
    return make_condition(pictures["sketch"], hints), pictures["normal"]


def _batches(network: N, size: int, answer: _Answer[N]) -> None:
    """Run the network on one and on three pictures, in training and in evaluation mode."""
    for count in (1, 3):
        for training in (True, False):
            answer(network.train(training), *_given(count, size))


def _learning(network: N, size: int, answer: _Answer[N]) -> None:
    """Check that every parameter gets a finite gradient, and that not all gradients are zero."""
    network.train()
    network.zero_grad()
    torch.manual_seed(0)
    loss = torch.stack([part.float().square().mean() for part in answer(network, *_given(2, size))]).sum()
    loss.backward()
    learning = {name: p for name, p in network.named_parameters() if p.requires_grad}
    idle = [name for name, parameter in learning.items() if parameter.grad is None]
    asked = "each parameter must affect the output, or have requires_grad=False"
    demand(not idle, network, f"gives no gradient to {', '.join(idle[:3])}", asked)
    grads = [p.grad for p in learning.values() if p.grad is not None]
    finite = all(bool(grad.isfinite().all()) for grad in grads)
    demand(finite, network, "has a gradient that is infinite or nan", "gradients must be finite")
    moves = any(bool(grad.any()) for grad in grads)
    demand(moves, network, "has only zero gradients", "a loss on its output must reach its parameters")
    network.zero_grad()


def _looking(network: N, size: int, answer: _Answer[N], sees_normals: bool) -> None:
    """Check that the output depends on each input."""
    network.eval()
    condition, normal = (part.requires_grad_() for part in _given(2, size))
    total = torch.stack([part.float().square().mean() for part in answer(network, condition, normal)]).sum()
    demand(total.requires_grad, network, "returns an output without a gradient", "it must be differentiable")
    inputs = {"the condition": condition} | ({"the normals": normal} if sees_normals else {})
    grads = torch.autograd.grad(total, list(inputs.values()), allow_unused=True)
    for (name, _), grad in zip(inputs.items(), grads, strict=True):
        looked = grad is not None and bool(grad.any())
        demand(looked, network, f"ignores {name}", "its output must depend on all inputs")


@torch.no_grad()
def _repeating(network: N, size: int, answer: _Answer[N]) -> None:
    """Check that equal inputs give equal outputs, in training under the same seed."""
    for training in (False, True):
        network.train(training)
        answers = []
        for _ in range(2):
            if training:
                torch.manual_seed(3)
            answers.append(answer(copy.deepcopy(network), *_given(2, size)))
        same = all(torch.equal(one, other) for one, other in zip(*answers, strict=True))
        when = "in training for the same torch seed" if training else "in evaluation"
        asked = "draw random numbers only from torch, and none in evaluation mode, for reproducible runs"
        demand(same, network, f"returns different outputs for the same input {when}", asked)


@torch.no_grad()
def _independence(network: N, size: int, answer: _Answer[N]) -> None:
    """Check that in evaluation mode an output does not depend on the other pictures of the batch."""
    network.eval()
    condition, normal = _given(3, size)
    whole = answer(network, condition, normal)
    single = answer(network, condition[1:2], normal[1:2])
    for one, other in zip(whole, single, strict=True):
        apart = float((one[1:2] - other).abs().max() / other.abs().max().clamp(min=1))
        asked = "in evaluation mode, a picture must not depend on the others of its batch"
        demand(
            apart < _CLOSE,
            network,
            f"differs by {apart:.2g} between a picture in a batch and the same picture alone",
            asked,
        )


def _state(network: N, size: int, answer: _Answer[N]) -> None:
    """Check that after training the state_dict alone determines the output."""
    trained, fresh = copy.deepcopy(network).train(), copy.deepcopy(network)
    optimizer = torch.optim.SGD([p for p in trained.parameters() if p.requires_grad], lr=1e-3)
    for _ in range(2):
        optimizer.zero_grad()
        parts = answer(trained, *_given(2, size))
        torch.stack([part.float().square().mean() for part in parts]).sum().backward()
        optimizer.step()
    with torch.no_grad():
        for tensor in [*fresh.parameters(), *fresh.buffers()]:
            if tensor.is_floating_point():
                tensor.add_(0.5)
        fresh.load_state_dict(trained.state_dict())
        before, after = (answer(each.eval(), *_given(1, size)) for each in (trained, fresh))
    same = all(torch.equal(one, two) for one, two in zip(before, after, strict=True))
    asked = "keep all learnt values in parameters and persistent buffers"
    demand(same, network, "gives another output after its state_dict was loaded", asked)


@torch.no_grad()
def _on_device(network: N, size: int, answer: _Answer[N], device: torch.device) -> tuple[Tensor, ...]:
    inputs = (part.to(device) for part in _given(1, size))
    try:
        return answer(network.to(device).eval(), *inputs)
    finally:
        network.cpu()
