"""Bits: one of a file turned over, as a bad disk does it."""

from pathlib import Path

import numpy as np


def flip(path: Path, rng: np.random.Generator) -> int:
    """Turn one bit of a file over, and return which."""
    content = bytearray(path.read_bytes())
    bit = int(rng.integers(8 * len(content)))
    content[bit // 8] ^= 1 << bit % 8
    path.write_bytes(content)
    return bit
