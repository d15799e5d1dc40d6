"""Checks of a discriminator."""

import torch
from torch import Tensor

from normalgan.models import Discriminator
from normalgan.models.base import check_scores
from normalgan.testing.conformance import Check, demand, held_to_contract, promised
from normalgan.testing.networks import given, network_checks
from normalgan.testing.settings import settings_checks

__all__ = ["discriminator_checks"]


def discriminator_checks(size: int = 64) -> list[Check[Discriminator]]:
    """Return the checks of a discriminator for pictures of a size, for ``pytest.mark.parametrize``."""
    contract = promised(Discriminator.forward)
    return [
        *settings_checks(Discriminator),  # type: ignore[type-abstract]
        Check("shape and type", lambda d: _shape(d, size), contract),
        *network_checks(size, _score, sees_normals=True, contract=contract),
    ]


def _score(discriminator: Discriminator, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
    scores = discriminator(condition, normal)
    with held_to_contract():
        return check_scores(discriminator, scores, condition)


@torch.no_grad()
def _shape(discriminator: Discriminator, size: int) -> None:
    condition, normal = given(2, size)
    for score in _score(discriminator.eval(), condition, normal):
        did = f"returned scores of {score.dtype} for normals of torch.float32"
        demand(score.dtype == torch.float32, discriminator, did, "it must keep the type")
        demand(
            score.isfinite().all(), discriminator, "gave a score that is not finite", "scores must be finite"
        )
