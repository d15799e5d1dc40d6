"""Cost: count a generator's operations, measure its speed, and describe the machine."""

import os
import platform
from importlib.metadata import version
from itertools import count
from pathlib import Path
from time import perf_counter
from typing import Any

import torch
from lightning.fabric.utilities import move_data_to_device
from torch import nn
from torch.utils.flop_counter import FlopCounterMode

from normalgan.batch import Batch
from normalgan.benchmark.measure import true_float32
from normalgan.benchmark.methods import Method
from normalgan.commit import commit
from normalgan.version import __version__

_PACKAGES = ("torch", "lightning", "numpy", "kornia", "torchmetrics")


def flops(network: nn.Module, size: int, device: torch.device) -> int:
    """Return the floating-point operations per map; a multiply-add counts as two.

    Only convolutions and matrix products, which make up nearly all operations, are counted.

    Args:
        network: a generator with inputs (N, 4, size, size).
        size: height and width in pixels.
        device: device of the network.
    """
    with torch.no_grad(), FlopCounterMode(display=False) as counter:
        network(torch.zeros(1, 4, size, size, device=device))
    return int(counter.get_total_flops())


def images_per_second(method: Method, batch: Batch, device: torch.device, seconds: float = 1.0) -> float:
    """Return the number of maps predicted per second, measured for ``seconds`` after a warm-up batch."""
    here: Batch = move_data_to_device(batch, device)
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
    """Wait until the device has finished its asynchronous work."""
    if device.type == "cuda":
        torch.cuda.synchronize(device)


def describe_origin(device: torch.device) -> dict[str, Any]:
    """Return the ``machine`` (without its name), package ``versions`` and ``commit`` behind the figures."""
    machine: dict[str, str | int] = {
        "system": platform.system(),
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
        "threads": torch.get_num_threads(),
    }
    if device.type == "cuda":
        machine["gpu"] = torch.cuda.get_device_name(device)
    versions = {"python": platform.python_version(), "normalgan": __version__}
    versions |= {name: version(name) for name in _PACKAGES}
    return {"machine": machine, "versions": versions, "commit": commit()}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.machine()
