"""What is asked of a generator."""

from typing import cast

import torch
from torch import Tensor

from normalgan.models import Generator
from normalgan.testing.conformance import Check, called, demand, hold
from normalgan.testing.networks import given, network_checks
from normalgan.testing.settings import settings_checks

_PAINTED = "forward must take (N, 4, H, W) and return (N, 3, H, W), or a fourth channel of confidence"


def check_generator(generator: Generator, size: int = 64) -> None:
    """Ask a generator everything that its kind must do. Its mode and the random state of torch may change.

    Args:
        generator: with the settings it is to be checked with; small ones save time.
        size: side in pixels of pictures that it takes.

    Raises:
        ConformanceError: at the first thing that it does otherwise, in one sentence.
    """
    hold(generator, generator_checks(size))


def generator_checks(size: int = 64) -> list[Check[Generator]]:
    """Return the checks of a generator for pictures of a size, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Generator),  # type: ignore[type-abstract]
        Check("shape and type", lambda g: _shape(g, size), _PAINTED),
        Check("range", lambda g: _range(g, size), "normals lie in [-1, 1], a confidence above 0"),
        *network_checks(size, _answer, sees_normals=False, contract=_PAINTED),
    ]


def _answer(generator: Generator, condition: Tensor, _: Tensor) -> tuple[Tensor, ...]:
    return (_paint(generator, condition),)


def _paint(generator: Generator, condition: Tensor) -> Tensor:
    painted = generator(condition)
    shape = tuple(painted.shape) if isinstance(painted, Tensor) else called(painted)
    count, _, height, width = condition.shape
    wanted = [(count, channels, height, width) for channels in (3, 4)]
    asked = f"it must return normals {wanted[0]}, or {wanted[1]} with a confidence"
    demand(shape in wanted, generator, f"returned {shape} for a condition of {tuple(condition.shape)}", asked)
    return cast("Tensor", painted)


@torch.no_grad()
def _shape(generator: Generator, size: int) -> None:
    painted = _paint(generator.eval(), given(2, size)[0])
    did = f"returned {painted.dtype} for a condition of torch.float32"
    demand(painted.dtype == torch.float32, generator, did, "it must keep the type")


@torch.no_grad()
def _range(generator: Generator, size: int) -> None:
    for scale in (1.0, 100.0):  # the second drives it to its limits
        painted = _paint(generator.eval(), scale * given(2, size)[0])
        normals, confidence = painted[:, :3], painted[:, 3:]
        demand(painted.isfinite().all(), generator, "painted what is no number", "its answer must be finite")
        largest = float(normals.abs().max())
        asked = "each component must lie in [-1, 1], as by tanh"
        demand(largest <= 1 + 1e-5, generator, f"painted a component of {largest:.3g}", asked)
        positive = bool((confidence > 0).all())
        demand(positive, generator, "painted a confidence of 0 or less", "the fourth channel must be above 0")
