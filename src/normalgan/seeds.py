"""Seeds for the parts of a run, so that each draws its own numbers, and the same ones when resumed."""

import hashlib
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import torch

__all__ = ["derive_seed", "rng_of", "seed_torch"]


def derive_seed(*parts: int | str) -> int:
    """Return a seed that depends on every part and on nothing else, the same on every machine.

    >>> derive_seed("hints", 1) == derive_seed("hints", 1) != derive_seed("hints", 2)
    True
    """
    return int.from_bytes(hashlib.sha256(repr(parts).encode()).digest()[:7], "little")


def rng_of(name: str, number: int) -> np.random.Generator:
    """Return the source of randomness of one of many things of a name, the same on every machine.

    >>> bool(rng_of("horse", 3).random() == rng_of("horse", 3).random() != rng_of("horse", 4).random())
    True
    """
    return np.random.default_rng([zlib.crc32(name.encode()), number])


def seed_torch(seed: int, device: "torch.device") -> None:
    """Seed torch's generators of the processor and of a device, as `torch.manual_seed` does for all devices.

    Where a backend was not started, `torch.manual_seed` notes each call with its stack for later, anew at
    every step: time, and memory that grows.

    >>> import torch
    >>> seed_torch(3, torch.device("cpu"))
    >>> bool((torch.rand(2) == torch.rand(2, generator=torch.Generator().manual_seed(3))).all())
    True
    """
    import torch  # late: shapes are seeded too, without it

    torch.default_generator.manual_seed(seed)
    if device.type == "cuda":
        with torch.cuda.device(device):
            torch.cuda.manual_seed(seed)
    elif device.type == "mps":
        torch.mps.manual_seed(seed)
