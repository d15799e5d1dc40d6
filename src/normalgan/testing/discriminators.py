"""Checks of a discriminator."""

from typing import cast

import torch
from torch import Tensor

from normalgan.models import Discriminator
from normalgan.testing.conformance import Check, class_name, demand
from normalgan.testing.networks import given, network_checks
from normalgan.testing.settings import settings_checks

__all__ = ["discriminator_checks"]

_SCORES = "forward must take the condition and the normals and return a tuple of scores, one tensor a head"


def discriminator_checks(size: int = 64) -> list[Check[Discriminator]]:
    """Return the checks of a discriminator for pictures of a size, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Discriminator),  # type: ignore[type-abstract]
        Check("shape and type", lambda d: _shape(d, size), _SCORES),
        *network_checks(size, _score, sees_normals=True, contract=_SCORES),
    ]


def _score(discriminator: Discriminator, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
    scores = discriminator(condition, normal)
    is_tuple = isinstance(scores, tuple) and len(scores) > 0 and all(isinstance(s, Tensor) for s in scores)
    asked = "it must return a tuple of scores, one tensor a head"
    demand(is_tuple, discriminator, f"returned {class_name(scores)}", asked)
    for score in scores:
        good = score.ndim > 0 and len(score) == len(normal)
        did = f"returned scores of {tuple(score.shape)} for {len(normal)} pictures"
        demand(good, discriminator, did, "the first axis of each head must be that of the pictures")
    return cast("tuple[Tensor, ...]", scores)


@torch.no_grad()
def _shape(discriminator: Discriminator, size: int) -> None:
    condition, normal = given(2, size)
    for score in _score(discriminator.eval(), condition, normal):
        did = f"returned scores of {score.dtype} for normals of torch.float32"
        demand(score.dtype == torch.float32, discriminator, did, "it must keep the type")
        demand(
            score.isfinite().all(), discriminator, "gave a score that is no number", "scores must be finite"
        )
