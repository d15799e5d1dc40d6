"""Finite losses: a loss that is no number stops the run before it spoils the weights."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.errors import RunError

__all__ = ["FEW", "LossError", "async_to_cpu", "loss_error", "not_finite", "watch"]

FEW = 8
"""More names of samples than this no one reads."""


class LossError(RunError):
    """A loss is NaN or infinite."""

    def keep(self, path: Path) -> None:
        """Add where the weights from before the step are kept."""
        self.args = (f"{self} The weights from before this step are in {path}.",)


def async_to_cpu(values: Tensor) -> Callable[[], list[float]]:
    """Begin to bring numbers (N,) to the CPU, and return what waits for them and returns them.

    A GPU goes on meanwhile with what it is told next, such as the backward pass: the copy waits for nothing
    that was asked for after it. ``tolist`` would wait for all, and leave the GPU idle until it is told more.
    """
    if values.device.type != "cuda":
        return values.tolist
    copies = _stream(values.device.index)
    copies.wait_stream(torch.cuda.current_stream(values.device))
    with torch.cuda.stream(copies):
        here = torch.empty(values.shape, dtype=values.dtype, pin_memory=True)
        here.copy_(values, non_blocking=True)
        values.record_stream(copies)
        arrived = torch.cuda.Event()
        arrived.record(copies)

    def read() -> list[float]:
        arrived.synchronize()
        there: list[float] = here.tolist()
        return there

    return read


@lru_cache
def _stream(device: int) -> torch.cuda.Stream:
    return torch.cuda.Stream(device)


def not_finite(losses: Mapping[Any, float]) -> list[str]:
    """Return the losses that are NaN or infinite, each with its value.

    >>> not_finite({"l1": 0.5, "hints": float("nan")})
    ['hints is nan']
    """
    return [f"{name} is {value}" for name, value in losses.items() if not math.isfinite(value)]


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


def watch(losses: Mapping[str, Tensor], processes: int) -> Callable[[Batch, int, int], dict[str, Tensor]]:
    """Begin to read losses while backward is at work, and return what checks them before the weights change.

    It takes the batch, the epoch and the number of the batch in it, and returns the losses on the CPU: to log
    a figure that is on a GPU would wait for it.

    Args:
        losses: scalars by name.
        processes: how many train together. One that stopped alone would leave the others waiting, so the sum
            of all is checked too.

    Raises:
        LossError: from what is returned, where the step would make all weights NaN; in every process.
    """
    values = torch.stack([value.detach().float() for value in losses.values()])
    if processes > 1:
        total = values.clone()
        torch.distributed.all_reduce(total)  # Lightning's own reduction waits for all processes first
        values = torch.cat([values, total])
    read = async_to_cpu(values)

    def check(batch: Batch, epoch: int, batch_idx: int) -> dict[str, Tensor]:
        numbers = read()
        own = dict(zip(losses, numbers, strict=False))
        if not_finite(dict(enumerate(numbers))):
            raise loss_error(not_finite(own), batch.get("name", []), epoch, batch_idx)
        return {name: torch.tensor(number) for name, number in own.items()}

    return check
