"""Checks of losses: adversarial objectives and reconstruction losses."""

import copy

import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.losses import AdversarialObjective, Reconstruction, Scores, Term
from normalgan.losses.checks import check_losses, check_terms
from normalgan.models.predictions import Predictions
from normalgan.testing.conformance import Check, demand, held_to_contract, promised, untouched_check
from normalgan.testing.pictures import pictures
from normalgan.testing.settings import settings_checks

_LOSSES = "both losses must be scalars computed from scores, one tensor per head"
_TERMS = promised(Reconstruction.terms)
_TAKEN = {"adversarial", "discriminator"}
"""Names of terms that training itself logs."""


def objective_checks() -> list[Check[AdversarialObjective]]:
    """Return the checks of an adversarial objective, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(AdversarialObjective),  # type: ignore[type-abstract]
        Check("scalar losses", _losses, _LOSSES),
        Check(
            "losses that decrease in the right direction",
            _directions,
            "high scores mean true, and losses are minimised",
        ),
        Check("equal weight of heads", _heads, _LOSSES),
        Check("scalar penalty", _penalty, "penalty must return a scalar"),
        Check(
            "the hook after the discriminator's step",
            _after_step,
            "after_discriminator_step must accept any discriminator",
        ),
        Check("one-sentence errors", _refusal, "check may raise only InputError"),
    ]


class _Critic(nn.Module):
    """A minimal critic with two heads: scores of patches, and one score of the picture."""

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
    # At a score of 0.5, where squared losses around 0 or 1 and hinge losses all have a slope.
    fake, true, predicted = _scores(2), _scores(2), _scores(2)
    slope = _slope(objective.generator_loss(fake), fake)
    asked = "high scores mean true, so the generator must raise the scores of its maps"
    demand(slope < 0, objective, "does not lower generator_loss as scores rise", asked)
    loss = objective.discriminator_loss(true, predicted)
    asked = "the discriminator must raise the scores of true maps and lower those of predicted maps"
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
    did = f"weights a head of 16 scores and a head of one score as {shares[0]:.3g} to {shares[1]:.3g}"
    demand(equal, objective, did, "heads must have equal weight, whatever their number of scores")


def _penalty(objective: AdversarialObjective) -> None:
    real, fake = pictures(3, 16, 16)[0], torch.rand(3, 3, 16, 16)
    torch.manual_seed(0)
    critic = _Critic()
    penalties = []
    for _ in range(2):
        torch.manual_seed(1)
        penalties.append(objective.penalty(critic, real, fake))
        _demand_scalar(objective, "penalty", penalties[-1])
    asked = "draw random numbers only from torch, so that a resumed run is reproducible"
    demand(
        penalties[0] == penalties[1], objective, "returned different penalties for the same torch seed", asked
    )
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
        asked = "after_discriminator_step must keep the shapes of weights, and finite values"
        demand(good, objective, f"corrupted {name} of the discriminator", asked)


def _refusal(objective: AdversarialObjective) -> None:
    for discriminator in (_Critic(), nn.Sequential(nn.Conv2d(3, 1, 1), nn.BatchNorm2d(1))):
        try:
            objective.check(discriminator)
        except InputError as error:
            one = len(str(error).splitlines()) == 1
            demand(
                one, objective, "refuses a discriminator in several lines", "an InputError is one sentence"
            )


def reconstruction_checks() -> list[Check[Reconstruction]]:
    """Return the checks of a reconstruction loss, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Reconstruction),  # type: ignore[type-abstract]
        Check("scalar terms", _terms, _TERMS),
        Check("a minimum at the true normals", _least_at_truth, _TERMS),
        Check(
            "a finite gradient",
            _gradient,
            "its gradient must be finite, even at the true normals and at zero",
        ),
        Check(
            "pictures without an object or hints",
            _empty,
            "the loss must be finite even if there is nothing to compare",
        ),
        untouched_check(lambda loss, given: _compare(loss, given[0] / 2, *given), lambda: pictures(2)),
    ]


def _compare(
    reconstruction: Reconstruction, normals: Tensor, target: Tensor, mask: Tensor
) -> tuple[Tensor, Tensor, dict[str, Term]]:
    """Return the weighted loss, the directions (a leaf tensor) that it was computed from, and the terms."""
    where = torch.zeros_like(mask)
    where[..., ::5, ::5] = 1
    directions, terms = normals.detach().requires_grad_(), None
    try:
        terms = reconstruction.terms(Predictions(directions), target, mask, where * mask)
    except InputError:  # the loss needs presence and confidence
        length = normals.norm(dim=1, keepdim=True)
        directions = (normals / length.clamp(min=1e-6)).detach().requires_grad_()
        logits = torch.logit(length.clamp(1e-6, 1 - 1e-6))
        preds = Predictions(directions, logits, torch.ones_like(mask))
        terms = reconstruction.terms(preds, target, mask, where * mask)
    with held_to_contract():
        check_terms(reconstruction, terms, alone=True)
    return torch.stack([term.weight * term.value for term in terms.values()]).sum(), directions, terms


def _terms(reconstruction: Reconstruction) -> None:
    for count in (1, 3):
        target, mask = pictures(count)
        _, _, terms = _compare(reconstruction, 0.5 * target, target, mask)
        for name, term in terms.items():
            demand(
                name not in _TAKEN,
                reconstruction,
                f"has a term named {name}",
                "training itself logs a term of this name; rename yours",
            )
            finite = bool(term.value.isfinite())
            demand(
                finite,
                reconstruction,
                f"returned {term.value.item()} as its term {name}",
                "it must be finite",
            )
            demand(
                term.weight >= 0,
                reconstruction,
                f"gives {name} the weight {term.weight}",
                "weights must be 0 or more",
            )


def _least_at_truth(reconstruction: Reconstruction) -> None:
    target, mask = pictures(2)
    true, _, _ = _compare(reconstruction, target, target, mask)
    for did, wrong in (
        ("mirrored normals", target * torch.tensor([-1.0, 1, 1]).view(3, 1, 1)),
        ("nothing", 0 * target),
    ):
        false, _, _ = _compare(reconstruction, wrong, target, mask)
        demand(
            true < false,
            reconstruction,
            f"is {true.item():.3g} for the true normals and {false.item():.3g} for {did}",
            "the loss is minimised, so it must be smaller for the true normals",
        )


def _gradient(reconstruction: Reconstruction) -> None:
    target, mask = pictures(2)
    for place, normals in (
        ("at the true normals", target),
        ("where nothing is predicted", 0 * target),
        ("halfway", target / 2),
    ):
        loss, directions, _ = _compare(reconstruction, normals, target, mask)
        (grad,) = torch.autograd.grad(loss, directions)
        finite = bool(grad.isfinite().all())
        asked = "a single infinite value would corrupt all weights"
        demand(finite, reconstruction, f"has a gradient that is infinite or nan {place}", asked)
    demand(grad.any(), reconstruction, "teaches the normals nothing", "its gradient must reach them")


def _empty(reconstruction: Reconstruction) -> None:
    target, mask = (torch.zeros_like(part) for part in pictures(2))
    loss, _, _ = _compare(reconstruction, target, target, mask)
    did = f"is {loss.item()} for pictures without an object or a hint"
    demand(loss.isfinite(), reconstruction, did, "it must be finite; avoid a mean over no pixels")
