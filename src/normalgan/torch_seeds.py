"""Seeding torch's global randomness for one device."""

import torch

__all__ = ["seed_torch"]


def seed_torch(seed: int, device: torch.device) -> None:
    """Seed the generators of the processor and of a device, as `torch.manual_seed` does for all devices.

    Where a backend was not started, `torch.manual_seed` notes each call with its stack for later, anew at
    every step: time, and memory that grows.

    >>> seed_torch(3, torch.device("cpu"))
    >>> bool((torch.rand(2) == torch.rand(2, generator=torch.Generator().manual_seed(3))).all())
    True
    """
    torch.default_generator.manual_seed(seed)
    if device.type == "cuda":
        with torch.cuda.device(device):
            torch.cuda.manual_seed(seed)
    elif device.type == "mps":
        torch.mps.manual_seed(seed)
