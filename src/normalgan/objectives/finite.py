"""Finite losses: a loss that is no number stops the run before it spoils the weights."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor

from normalgan.errors import RunError

FEW = 8
"""More names of samples than this no one reads."""


class LossError(RunError):
    """A loss is NaN or infinite."""

    def keep(self, path: Path) -> None:
        """Add where the weights from before the step are kept."""
        self.args = (f"{self} The weights from before this step are in {path}.",)


def not_finite(losses: Mapping[str, Tensor]) -> list[str]:
    """Return the losses that are NaN or infinite, each with its value.

    Args:
        losses: scalars by name. They are brought to the CPU in one go: each transfer waits for the device.

    >>> not_finite({"l1": torch.tensor(0.5), "hints": torch.tensor(float("nan"))})
    ['hints is nan']
    """
    values = torch.stack([value.detach().float() for value in losses.values()]).tolist()
    return [
        f"{name} is {value}"
        for name, value in zip(losses, values, strict=True)
        if not -float("inf") < value < float("inf")
    ]


def loss_error(bad: Sequence[str], names: Sequence[str], epoch: int, batch: int) -> LossError:
    """Return what to raise for losses that are not finite.

    Args:
        bad: what `not_finite` returned; empty where that happened in another process only.
        names: of the samples in the batch.
        epoch: counted from 0.
        batch: number of the batch in the epoch, from 0.
    """
    more = f" and {len(names) - FEW} more" if len(names) > FEW else ""
    which = ", ".join(bad) if bad else "a loss of another process is not finite"
    return LossError(
        f"the loss cannot be followed any further ({which}) in epoch {epoch}, batch {batch}, with the "
        f"samples {', '.join(names[:FEW])}{more}; lower the learning rates, or look at these samples."
    )
