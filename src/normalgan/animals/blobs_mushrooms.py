"""Mushrooms."""

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.forms import ball, by, fuse, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def mushroom(pose: str, rng: Rng) -> list[Part]:
    """Return a mushroom, with a small one beside it or a collar on some."""
    parts = _mushroom(rng, np.zeros(3), 1.0, blend=0.0)
    if rng.uniform() < 0.4:
        at = np.array([0.10, 0.0, float(rng.choice((-1, 1))) * 0.12])
        parts += _mushroom(rng, at, float(rng.uniform(0.45, 0.6)), blend=0.03, lean=0.15)
    return parts


def _mushroom(rng: Rng, at: np.ndarray, size: float, blend: float, lean: float = 0.0) -> list[Part]:
    f = factors(rng, 0.22, "tall", "stem", "cap", "high")
    stem, tall = 0.10 * f["stem"] * size, 0.62 * f["tall"] * size
    wide, high = 0.38 * f["cap"] * size, 0.30 * f["high"] * size
    away = at * lean * 8 + rng.uniform(-0.05, 0.05, 3) * [1, 0, 1]
    top = by(at, 0, tall, 0) + away
    cap = ball(top, [wide, high, wide])
    hollow = ball(top - [0, 0.62 * high, 0], [0.86 * wide, 0.62 * high, 0.86 * wide])
    stalk = tube(
        [by(at, 0, 0.0, 0), by(at, 0, 0.3 * tall, 0) + 0.3 * away, by(top, 0, 0.3 * high, 0)],
        [1.7 * stem, stem, 0.9 * stem],
    )
    dome = [fuse(cap, blend=blend), fuse(hollow, blend=0.04 * size, carve=True)]
    parts = [*dome, fuse(stalk, blend=0.02 * size)]
    if rng.uniform() < 0.4:
        spots = []
        for _ in range(9):
            a, e = rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(25, 90))
            ray = np.array([np.cos(a) * np.cos(e), np.sin(e), np.sin(a) * np.cos(e)])
            spots.append(ball(top + ray * [wide, high, wide], 0.05 * size * float(rng.uniform(0.7, 1.3))))
        parts.append(fuse(*spots, blend=0.03 * size))
    return parts
