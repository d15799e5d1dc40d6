"""Finite losses: a NaN or infinite loss stops the run before it corrupts the weights."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.errors import RunError

_FEW = 8
"""Maximum number of sample names in a message."""


class LossError(RunError):
    """Error for a loss that is NaN or infinite."""

    def keep(self, path: Path) -> None:
        """Add the path of the weights from before the step to the message."""
        self.args = (f"{self} The weights from before this step are in {path}.",)


def start_finite_check(
    losses: Mapping[str, Tensor], processes: int
) -> Callable[[Batch, int, int], dict[str, Tensor]]:
    """Start copying losses to the CPU; return the check to call after the backward pass, before the step.

    The copy runs during the backward pass. The check takes the batch, the epoch and the index of the batch,
    and returns the losses on the CPU, so that logging them does not wait for the GPU.

    Args:
        losses: scalars by name.
        processes: number of processes that train together. If one of them stopped alone, the others would
            hang, so the sum over all processes is checked too.

    Raises:
        LossError: raised by the returned check, in every process, if a loss is not finite.
    """
    values = torch.stack([value.detach().float() for value in losses.values()])
    if processes > 1:
        total = values.clone()
        torch.distributed.all_reduce(total)  # Lightning's own reduction first waits for all processes
        values = torch.cat([values, total])
    read = async_to_cpu(values)

    def check(batch: Batch, epoch: int, batch_idx: int) -> dict[str, Tensor]:
        numbers = read()
        own = dict(zip(losses, numbers, strict=False))
        if not_finite(dict(enumerate(numbers))):
            raise loss_error(not_finite(own), batch.get("name", []), epoch, batch_idx)
        return {name: torch.tensor(number) for name, number in own.items()}

    return check


def async_to_cpu(values: Tensor) -> Callable[[], list[float]]:
    """Start copying values (N,) to the CPU and return a function that waits for them.

    Meanwhile the GPU continues with queued work, such as the backward pass. ``tolist`` would wait for all
    queued work and then leave the GPU idle.
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
        return here.tolist()

    return read


@lru_cache
def _stream(device: int) -> torch.cuda.Stream:
    return torch.cuda.Stream(device)


def not_finite(losses: Mapping[Any, float]) -> list[str]:
    """Return descriptions of the losses that are NaN or infinite, with their values.

    >>> not_finite({"l1": 0.5, "hints": float("nan")})
    ['hints is nan']
    """
    return [f"{name} is {value}" for name, value in losses.items() if not math.isfinite(value)]


def loss_error(bad: Sequence[str], names: Sequence[str], epoch: int, batch: int) -> LossError:
    """Return the error for losses that are not finite.

    Args:
        bad: descriptions from `not_finite`; empty if only another process has such a loss.
        names: names of the samples in the batch.
        epoch: index of the epoch, from 0.
        batch: index of the batch in the epoch, from 0.
    """
    more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
    which = ", ".join(bad) if bad else "a loss of another process is not finite"
    return LossError(
        f"the loss is not finite ({which}) in epoch {epoch + 1}, batch {batch + 1}, with the "
        f"samples {', '.join(names[:_FEW])}{more}; lower the learning rates, or look at these samples."
    )
