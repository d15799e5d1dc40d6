"""Seeds for the parts of a run: independent of each other, and reproducible when a run is resumed."""

import hashlib
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import torch


def derive_seed(*parts: int | str) -> int:
    """Return a seed that depends only on the parts, not on the machine.

    >>> derive_seed("hints", 1) == derive_seed("hints", 1) != derive_seed("hints", 2)
    True
    """
    return int.from_bytes(hashlib.sha256(repr(parts).encode()).digest()[:7], "little")


def rng_of(name: str, number: int) -> np.random.Generator:
    """Return a random generator seeded with a name and a number, the same on every machine.

    >>> bool(rng_of("horse", 3).random() == rng_of("horse", 3).random() != rng_of("horse", 4).random())
    True
    """
    return np.random.default_rng([zlib.crc32(name.encode()), number])


def seed_torch(seed: int, device: "torch.device") -> None:
    """Seed torch's random generators of the CPU and of one device.

    Unlike this, `torch.manual_seed` records each call with its stack for every backend that has not been
    initialised, which costs time and memory at each step.

    >>> import torch
    >>> seed_torch(3, torch.device("cpu"))
    >>> bool((torch.rand(2) == torch.rand(2, generator=torch.Generator().manual_seed(3))).all())
    True
    """
    import torch  # imported here because seeding shapes does not need torch

    torch.default_generator.manual_seed(seed)
    if device.type == "cuda":
        with torch.cuda.device(device):
            torch.cuda.manual_seed(seed)
    elif device.type == "mps":
        torch.mps.manual_seed(seed)
