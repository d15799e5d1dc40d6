"""Checks of a reconstruction loss."""

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.losses import Reconstruction, Term
from normalgan.losses.checks import check_terms
from normalgan.models.predictions import Predictions
from normalgan.testing.conformance import Check, demand, held_to_contract, promised, untouched
from normalgan.testing.pictures import pictures
from normalgan.testing.settings import settings_checks

__all__ = ["reconstruction_checks"]

_TERMS = promised(Reconstruction.terms)
_TAKEN = {"adversarial", "discriminator"}
"""What training logs itself."""


def reconstruction_checks() -> list[Check[Reconstruction]]:
    """Return the checks of a reconstruction loss, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Reconstruction),  # type: ignore[type-abstract]
        Check("terms that are numbers", _terms, _TERMS),
        Check("a loss least at the truth", _least_at_truth, _TERMS),
        Check("a finite gradient", _gradient, "its gradient must be finite, at the truth and at zero too"),
        Check("pictures without an object or hints", _empty, "nothing to compare must make a finite loss"),
        Check("arguments left as they are", _untouched, "the tensors belong to the caller"),
    ]


def _compare(
    reconstruction: Reconstruction, normals: Tensor, target: Tensor, mask: Tensor
) -> tuple[Tensor, Tensor, dict[str, Term]]:
    """Return the weighted loss, the directions that it was given (a leaf), and the terms."""
    where = torch.zeros_like(mask)
    where[..., ::5, ::5] = 1
    directions, terms = normals.detach().requires_grad_(), None
    try:
        terms = reconstruction.terms(Predictions(directions), target, mask, where * mask)
    except InputError:  # it wants a presence and a confidence
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
                "training logs one itself; rename it",
            )
            finite = bool(term.value.isfinite())
            demand(
                finite,
                reconstruction,
                f"returned {term.value.item()} as its term {name}",
                "it must be finite",
            )
            demand(
                term.weight >= 0, reconstruction, f"weighs {name} by {term.weight}", "weights are 0 or more"
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
            f"is {true.item():.3g} for the truth and {false.item():.3g} for {did}",
            "the loss is minimised, so it must be less for the truth",
        )


def _gradient(reconstruction: Reconstruction) -> None:
    target, mask = pictures(2)
    for place, normals in (
        ("at the truth", target),
        ("where nothing is predicted", 0 * target),
        ("halfway", target / 2),
    ):
        loss, directions, _ = _compare(reconstruction, normals, target, mask)
        (grad,) = torch.autograd.grad(loss, directions)
        finite = bool(grad.isfinite().all())
        asked = "one infinite value spoils all weights"
        demand(finite, reconstruction, f"has a gradient that is infinite or no number {place}", asked)
    demand(grad.any(), reconstruction, "teaches the normals nothing", "its gradient must reach them")


def _empty(reconstruction: Reconstruction) -> None:
    target, mask = (torch.zeros_like(part) for part in pictures(2))
    loss, _, _ = _compare(reconstruction, target, target, mask)
    did = f"is {loss.item()} for pictures without an object or a hint"
    demand(loss.isfinite(), reconstruction, did, "it must be finite; mind a mean of nothing")


def _untouched(reconstruction: Reconstruction) -> None:
    target, mask = pictures(2)
    with untouched(reconstruction, [target, mask]):
        _compare(reconstruction, target / 2, target, mask)
