"""Seeds for the parts of a run: independent of each other, and equal when a run is resumed."""

import hashlib
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import torch

__all__ = ["derive_seed", "rng_of", "seed_torch"]


def derive_seed(*parts: int | str) -> int:
    """Return a seed that depends only on the parts, equal on every machine.

    >>> derive_seed("hints", 1) == derive_seed("hints", 1) != derive_seed("hints", 2)
    True
    """
    return int.from_bytes(hashlib.sha256(repr(parts).encode()).digest()[:7], "little")


def rng_of(name: str, number: int) -> np.random.Generator:
    """Return the random generator for a name, the same on every machine.

    >>> bool(rng_of("horse", 3).random() == rng_of("horse", 3).random() != rng_of("horse", 4).random())
    True
    """
    return np.random.default_rng([zlib.crc32(name.encode()), number])


def seed_torch(seed: int, device: "torch.device") -> None:
    """Seed torch's generators of the CPU and of one device.

    For a backend that has not started, `torch.manual_seed` records each call with its stack, which costs time
    and memory at every step.

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
