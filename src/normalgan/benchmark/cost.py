"""Cost: the size of a generator, its work for a map, and its speed on this machine."""

from itertools import count
from time import perf_counter

import torch
from torch import nn
from torch.utils.flop_counter import FlopCounterMode

from normalgan.batch import Batch
from normalgan.benchmark.measure import moved, true_float32
from normalgan.benchmark.methods import Method

__all__ = ["flops", "images_per_second", "parameters"]


def parameters(network: nn.Module) -> int:
    """Return how many numbers a network learns.

    >>> parameters(nn.Linear(3, 2))
    8
    """
    return sum(parameter.numel() for parameter in network.parameters())


def flops(network: nn.Module, size: int, device: torch.device) -> int:
    """Return the floating-point operations of painting one map; a multiplication and an addition are two.

    Counted are convolutions and products of matrices, which is nearly all.

    Args:
        network: a generator, which takes (N, 4, size, size).
        size: H and W in pixels.
        device: where the network lies.
    """
    with torch.no_grad(), FlopCounterMode(display=False) as counter:
        network(torch.zeros(1, 4, size, size, device=device))
    return int(counter.get_total_flops())


def images_per_second(method: Method, batch: Batch, device: torch.device, seconds: float = 1.0) -> float:
    """Return how many maps are painted in a second, in batches of this one's size.

    Args:
        method: what paints.
        batch: what is painted, again and again.
        device: where.
        seconds: how long to go on; at least one batch is painted, after one to warm up.
    """
    here = moved(batch, device)
    with true_float32():
        method.predict(here, None)
        _wait(device)
        start = perf_counter()
        for predicted in count(len(batch["sketch"]), len(batch["sketch"])):
            method.predict(here, None)
            _wait(device)
            if (spent := perf_counter() - start) >= seconds:
                return predicted / spent
    raise AssertionError("the clock went on for ever")


def _wait(device: torch.device) -> None:
    """Wait for the device, which works on while Python goes ahead."""
    if device.type == "cuda":
        torch.cuda.synchronize(device)
