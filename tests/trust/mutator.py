"""A seeded mutator: sound files with bytes flipped, cut out, doubled, exchanged, or numbers made absurd."""

import re
from collections.abc import Callable

import numpy as np

ABSURD = (
    b"0",
    b"-1",
    b"1e400",
    b"nan",
    b"99999999999999999999",
    b"4294967295",
    b"[]",
    b'"',
    b"*a",
    b"\xff\xfe",
)
"""What is put in place of a number in a text."""


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """Return a file with one to four things wrong with it.

    Args:
        content: of a sound file.
        rng: where the choices come from; the same state gives the same bytes.
    """
    for _ in range(int(rng.integers(1, 5))):
        content = CHANGES[int(rng.integers(len(CHANGES)))](content, rng)
    return content


def _span(content: bytes, rng: np.random.Generator) -> tuple[int, int]:
    start = int(rng.integers(len(content) + 1))
    return start, min(len(content), start + int(2 ** rng.uniform(0, 10)))


def _flip(content: bytes, rng: np.random.Generator) -> bytes:
    """Change single bytes; half of the time among the first 256, where headers are."""
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 9))):
        if changed:
            reach = min(len(changed), 256) if rng.random() < 0.5 else len(changed)
            changed[int(rng.integers(reach))] = int(rng.integers(256))
    return bytes(changed)


def _cut_short(content: bytes, rng: np.random.Generator) -> bytes:
    return content[: int(rng.integers(len(content) + 1))]


def _cut_out(content: bytes, rng: np.random.Generator) -> bytes:
    start, end = _span(content, rng)
    return content[:start] + content[end:]


def _double(content: bytes, rng: np.random.Generator) -> bytes:
    start, end = _span(content, rng)
    return content[:end] + content[start:end] * int(rng.integers(1, 20)) + content[end:]


def _exchange(content: bytes, rng: np.random.Generator) -> bytes:
    (a, b), (c, d) = sorted((_span(content, rng), _span(content, rng)))
    return content if b > c else content[:a] + content[c:d] + content[b:c] + content[a:b] + content[d:]


def _number(content: bytes, rng: np.random.Generator) -> bytes:
    """Put something absurd in place of a number written in digits."""
    found = list(re.finditer(rb"-?\d+(?:\.\d+)?", content[: 2**16]))
    if not found:
        return content
    chosen = found[int(rng.integers(len(found)))]
    return content[: chosen.start()] + ABSURD[int(rng.integers(len(ABSURD)))] + content[chosen.end() :]


CHANGES: tuple[Callable[[bytes, np.random.Generator], bytes], ...] = (
    *(_flip, _cut_short, _cut_out, _double, _exchange, _number, _number),
)
