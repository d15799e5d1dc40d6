"""The machine and versions of a result."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

import torch

from normalgan.version import __version__

__all__ = ["describe_machine", "describe_versions"]

_PACKAGES = ("torch", "lightning", "numpy", "kornia", "torchmetrics")


def describe_machine(device: torch.device) -> dict[str, str | int]:
    """Return the hardware that speed depends on, without the machine's name."""
    described: dict[str, str | int] = {
        "system": platform.system(),
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
        "threads": torch.get_num_threads(),
    }
    if device.type == "cuda":
        described["gpu"] = torch.cuda.get_device_name(device)
    return described


def describe_versions() -> dict[str, str]:
    """Return the versions of Python, normalgan and the packages that figures depend on."""
    found = {name: version(name) for name in _PACKAGES}
    return {"python": platform.python_version(), "normalgan": __version__, **found}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.machine()
