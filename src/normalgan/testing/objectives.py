"""Checks of an adversarial objective."""

import copy

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.losses import AdversarialObjective, Scores
from normalgan.losses.checks import check_losses
from normalgan.testing.conformance import Check, demand, held_to_contract
from normalgan.testing.pictures import pictures
from normalgan.testing.settings import settings_checks

__all__ = ["objective_checks"]

_LOSSES = "both losses must be scalars made of scores, a tensor a head"


def objective_checks() -> list[Check[AdversarialObjective]]:
    """Return the checks of an adversarial objective, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(AdversarialObjective),  # type: ignore[type-abstract]
        Check("losses that are numbers", _losses, _LOSSES),
        Check("losses to be minimised", _directions, "high scores mean true, and losses are minimised"),
        Check("heads that count equally", _heads, _LOSSES),
        Check("a penalty that is a number", _penalty, "penalty must return a scalar"),
        Check("a step after the step", _after_step, "after_discriminator_step must take any discriminator"),
        Check("refusing with a sentence", _refusal, "check may raise InputError and nothing else"),
    ]


class _Critic(nn.Module):
    """A minimal critic of two heads: scores of patches, and one of the picture."""

    def __init__(self) -> None:
        super().__init__()
        self.patches = nn.Conv2d(3, 1, 4, 4)

    def forward(self, normal: Tensor) -> Scores:
        scores = self.patches(normal)
        return scores, scores.tanh().mean((2, 3))


def _scores(count: int) -> Scores:
    return tuple(torch.full(shape, 0.5, requires_grad=True) for shape in ((count, 1, 4, 4), (count, 1)))


def _losses(objective: AdversarialObjective) -> None:
    for count in (1, 3):
        generator, discriminator = _scores(count), (_scores(count), _scores(count))
        for name, loss in (
            ("generator_loss", objective.generator_loss(generator)),
            ("discriminator_loss", objective.discriminator_loss(*discriminator)),
        ):
            _demand_scalar(objective, name, loss)
            demand(loss.requires_grad, objective, f"returned a {name} without a gradient", _LOSSES)


def _demand_scalar(objective: AdversarialObjective, name: str, loss: Tensor) -> None:
    with held_to_contract():
        check_losses(objective, {name: loss})
    demand(loss.isfinite(), objective, f"returned {loss.item()} as {name}", f"{name} must be finite")


def _directions(objective: AdversarialObjective) -> None:
    # At a score of a half: a square about 0 or 1 has a slope there, and so has a hinge.
    fake, true, predicted = _scores(2), _scores(2), _scores(2)
    slope = _slope(objective.generator_loss(fake), fake)
    asked = "the generator wants its maps to be taken for true, and high scores mean true"
    demand(slope < 0, objective, "does not lower generator_loss as scores rise", asked)
    loss = objective.discriminator_loss(true, predicted)
    asked = "the discriminator wants high scores of true maps and low ones of predicted maps"
    demand(
        _slope(loss, true) < 0,
        objective,
        "does not lower discriminator_loss as true maps score higher",
        asked,
    )
    demand(
        _slope(loss, predicted) > 0,
        objective,
        "does not raise discriminator_loss as predicted maps score higher",
        asked,
    )


def _slope(loss: Tensor, scores: Scores) -> float:
    grads = torch.autograd.grad(loss, scores, retain_graph=True, allow_unused=True)
    return sum(float(grad.sum()) for grad in grads if grad is not None)


def _heads(objective: AdversarialObjective) -> None:
    fake = _scores(2)
    patches, single = torch.autograd.grad(objective.generator_loss(fake), fake, allow_unused=True)
    shares = [0.0 if grad is None else float(grad.sum()) for grad in (patches, single)]
    equal = abs(shares[0] - shares[1]) <= 1e-3 * max(map(abs, shares))
    did = f"weighs a head of 16 scores and a head of one as {shares[0]:.3g} to {shares[1]:.3g}"
    demand(equal, objective, did, "heads count equally, whatever their number of elements")


def _penalty(objective: AdversarialObjective) -> None:
    real, fake = pictures(3, 16, 16)[0], torch.rand(3, 3, 16, 16)
    torch.manual_seed(0)
    critic = _Critic()
    penalties = []
    for _ in range(2):
        torch.manual_seed(1)
        penalties.append(objective.penalty(critic, real, fake))
        _demand_scalar(objective, "penalty", penalties[-1])
    asked = "draw random numbers by torch alone, so that a resumed run repeats"
    demand(penalties[0] == penalties[1], objective, "returned two penalties under one seed of torch", asked)
    if penalties[0].requires_grad:
        torch.autograd.grad(penalties[0], list(critic.parameters()), allow_unused=True)
    else:
        asked = "it must teach the critic something"
        demand(penalties[0] == 0, objective, "returned a penalty without a gradient", asked)


def _after_step(objective: AdversarialObjective) -> None:
    critic = _Critic()
    before = copy.deepcopy(critic.state_dict())
    objective.after_discriminator_step(critic)
    for name, tensor in critic.state_dict().items():
        good = tensor.shape == before[name].shape and bool(tensor.isfinite().all())
        asked = (
            "after_discriminator_step may change weights, but not their shapes, and each must stay a number"
        )
        demand(good, objective, f"spoilt {name} of the discriminator", asked)


def _refusal(objective: AdversarialObjective) -> None:
    for discriminator in (_Critic(), nn.Sequential(nn.Conv2d(3, 1, 1), nn.BatchNorm2d(1))):
        try:
            objective.check(discriminator)
        except InputError as error:
            one = len(str(error).splitlines()) == 1
            demand(
                one, objective, "refuses a discriminator in several lines", "an InputError is one sentence"
            )
