"""Checks that losses return scalars with gradients."""

from collections.abc import Mapping

from torch import Tensor

from normalgan.contracts import class_name, describe, refused
from normalgan.errors import InputError
from normalgan.losses.adversarial import AdversarialObjective
from normalgan.losses.reconstruction import Reconstruction, Term


def check_losses(objective: AdversarialObjective, losses: Mapping[str, object]) -> None:
    """Check that an objective's losses, given by method name, are scalars.

    Raises:
        InputError: if a loss is not a scalar.
    """
    for name, value in losses.items():
        if not isinstance(value, Tensor) or value.ndim:
            raise InputError(
                f"{class_name(objective)}.{name} gave {describe(value)}; it gives a tensor of one number."
            )


def check_terms(reconstruction: Reconstruction, terms: object, alone: bool) -> None:
    """Check that a reconstruction loss returned scalar terms.

    Args:
        reconstruction: the loss.
        terms: output of the loss, which should map names to `Term`.
        alone: whether there is no other loss, so that at least one term is required.

    Raises:
        InputError: if the output is not such a mapping, or if the terms have no gradient.
    """
    asked = "a reconstruction loss gives its terms by name, a Term of a scalar tensor and its weight each"
    if not isinstance(terms, dict) or (alone and not terms):
        raise refused(reconstruction, terms, asked)
    for name, term in terms.items():
        if not isinstance(term, Term) or not isinstance(term.value, Tensor) or term.value.ndim:
            given = describe(term.value) if isinstance(term, Term) else describe(term)
            raise InputError(f"{class_name(reconstruction)} gave {given} as {name}; {asked}.")
    if terms and not any(term.value.requires_grad for term in terms.values()):
        raise InputError(
            f"{class_name(reconstruction)} gave terms without a gradient; do not detach the map."
        )
