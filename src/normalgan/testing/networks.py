"""Checks of all networks, generators and discriminators."""

import copy
from collections.abc import Callable
from typing import TypeVar

import torch
from torch import Tensor, nn

from normalgan.models.condition import make_condition
from normalgan.testing.conformance import Check, demand, device_check, untouched_check
from normalgan.testing.pictures import batch

__all__ = ["Answer", "given", "network_checks"]

N = TypeVar("N", bound=nn.Module)
Answer = Callable[[N, Tensor, Tensor], tuple[Tensor, ...]]
"""Runs a network on a condition (N, 4, H, W) and normals (N, 3, H, W) and returns its output."""

_CLOSE = 1e-4  # of answers in float32 that are the same but for the order of additions


def network_checks(size: int, answer: Answer[N], sees_normals: bool, contract: str) -> list[Check[N]]:
    """Return the checks that generators and discriminators share.

    Args:
        size: side in pixels of its inputs.
        answer: runs the network and checks the form of its output.
        sees_normals: whether the normals are an input.
        contract: what ``forward`` is to do.
    """
    return [
        Check("batches of any number", lambda n: _batches(n, size, answer), contract),
        Check("learning", lambda n: _learning(n, size, answer), "gradients must flow"),
        Check("looking at its input", lambda n: _looking(n, size, answer, sees_normals), contract),
        Check("repeating itself", lambda n: _repeating(n, size, answer), contract),
        Check("pictures apart", lambda n: _independence(n, size, answer), contract),
        untouched_check(lambda n, tensors: answer(n.eval(), *tensors), lambda: given(2, size)),
        Check("a state that can be loaded", lambda n: _state(n, size, answer), "load_state_dict must do"),
        device_check(lambda n, device: _on_device(n, size, answer, device)),
    ]


def given(count: int, size: int) -> tuple[Tensor, Tensor]:
    """Return a condition (N, 4, H, W) with a few hints, and the true normals (N, 3, H, W)."""
    pictures = batch(count, size)
    where = torch.zeros_like(pictures["mask"])
    where[..., size // 4 :: 5, size // 4 :: 7] = 1
    where = where * pictures["mask"]
    hints = torch.cat([pictures["normal"] * where, where], dim=1)
    return make_condition(pictures["sketch"], hints), pictures["normal"]


def _batches(network: N, size: int, answer: Answer[N]) -> None:
    """Run it on one picture and on three, in training and in evaluation."""
    for count in (1, 3):
        for training in (True, False):
            answer(network.train(training), *given(count, size))


def _learning(network: N, size: int, answer: Answer[N]) -> None:
    """Check that every parameter gets a finite gradient, and that not all gradients are zero."""
    network.train()
    network.zero_grad()
    torch.manual_seed(0)
    loss = torch.stack([part.float().square().mean() for part in answer(network, *given(2, size))]).sum()
    loss.backward()
    learning = {name: p for name, p in network.named_parameters() if p.requires_grad}
    idle = [name for name, parameter in learning.items() if parameter.grad is None]
    asked = "every parameter must take part in the answer, or have requires_grad off"
    demand(not idle, network, f"gives no gradient to {', '.join(idle[:3])}", asked)
    grads = [p.grad for p in learning.values() if p.grad is not None]
    finite = all(bool(grad.isfinite().all()) for grad in grads)
    demand(finite, network, "has a gradient that is infinite or no number", "gradients must be finite")
    moves = any(bool(grad.any()) for grad in grads)
    demand(moves, network, "has gradients of zero alone", "a loss of its answer must reach its parameters")
    network.zero_grad()


def _looking(network: N, size: int, answer: Answer[N], sees_normals: bool) -> None:
    """Demand that the output depends on every input."""
    network.eval()
    condition, normal = (part.requires_grad_() for part in given(2, size))
    total = torch.stack([part.float().square().mean() for part in answer(network, condition, normal)]).sum()
    demand(total.requires_grad, network, "answers without a gradient", "it must be differentiable")
    inputs = {"the condition": condition} | ({"the normals": normal} if sees_normals else {})
    grads = torch.autograd.grad(total, list(inputs.values()), allow_unused=True)
    for (name, _), grad in zip(inputs.items(), grads, strict=True):
        looked = grad is not None and bool(grad.any())
        demand(looked, network, f"does not look at {name}", "its answer must depend on all it is given")


@torch.no_grad()
def _repeating(network: N, size: int, answer: Answer[N]) -> None:
    """Demand the same output for the same input: always in evaluation, under one seed in training."""
    for training in (False, True):
        network.train(training)
        answers = []
        for _ in range(2):
            if training:
                torch.manual_seed(3)
            answers.append(answer(copy.deepcopy(network), *given(2, size)))
        same = all(torch.equal(one, other) for one, other in zip(*answers, strict=True))
        when = "in training under one seed of torch" if training else "in evaluation"
        asked = "draw random numbers by torch alone, and none in evaluation, so that a resumed run repeats"
        demand(same, network, f"answers twice the same differently {when}", asked)


@torch.no_grad()
def _independence(network: N, size: int, answer: Answer[N]) -> None:
    """Check that in evaluation an output does not depend on other pictures of the batch."""
    network.eval()
    condition, normal = given(3, size)
    whole = answer(network, condition, normal)
    single = answer(network, condition[1:2], normal[1:2])
    for one, other in zip(whole, single, strict=True):
        apart = float((one[1:2] - other).abs().max() / other.abs().max().clamp(min=1))
        asked = "in evaluation a picture must not depend on the others of its batch"
        demand(
            apart < _CLOSE,
            network,
            f"answers {apart:.2g} otherwise to a picture in a batch than alone",
            asked,
        )


def _state(network: N, size: int, answer: Answer[N]) -> None:
    """Check that after training the state_dict alone determines the output."""
    trained, fresh = copy.deepcopy(network).train(), copy.deepcopy(network)
    optimizer = torch.optim.SGD([p for p in trained.parameters() if p.requires_grad], lr=1e-3)
    for _ in range(2):
        optimizer.zero_grad()
        parts = answer(trained, *given(2, size))
        torch.stack([part.float().square().mean() for part in parts]).sum().backward()
        optimizer.step()
    with torch.no_grad():
        for tensor in [*fresh.parameters(), *fresh.buffers()]:
            if tensor.is_floating_point():
                tensor.add_(0.5)
        fresh.load_state_dict(trained.state_dict())
        before, after = (answer(each.eval(), *given(1, size)) for each in (trained, fresh))
    same = all(torch.equal(one, two) for one, two in zip(before, after, strict=True))
    asked = "keep what it has learnt in parameters and persistent buffers"
    demand(same, network, "answers otherwise after its state_dict was loaded", asked)


@torch.no_grad()
def _on_device(network: N, size: int, answer: Answer[N], device: torch.device) -> tuple[Tensor, ...]:
    inputs = (part.to(device) for part in given(1, size))
    try:
        return answer(network.to(device).eval(), *inputs)
    finally:
        network.cpu()
