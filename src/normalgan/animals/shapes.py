"""Trunks, pivots and two-boned limbs, as the body plans need them."""

from collections.abc import Sequence

import numpy as np

from normalgan.animals.chain import Frame
from normalgan.animals.forms import tube
from normalgan.animals.head import loft
from normalgan.animals.sweep import Floats, Sweep

Point = Sequence[float]
Rows = tuple[tuple[float, ...], ...]


def trunk(rows: Rows | Floats) -> Sweep:
    """Return the sweep of stations (x, top, bottom, half width) in the sagittal plane."""
    points, radii, widths = loft(tuple(tuple(float(value) for value in row) for row in rows))
    return tube(points, list(radii), list(widths))


def about(pivot: Point | Floats, rotation: Floats) -> Frame:
    """Return the frame that turns the world about a point."""
    fixed = np.array(pivot, dtype=np.float64)
    return Frame(fixed - rotation @ fixed, rotation)


def hinge(start: Floats, end: Floats, upper: float, lower: float, bend: Point = (-1.0, 0.0, 0.0)) -> Floats:
    """Return the joint (3,) between two bones that run from ``start`` to ``end``, bent towards ``bend``.

    Bones too short to reach lie straight, the joint dividing the way as their lengths do.

    >>> hinge(np.zeros(3), np.array([0.0, -6.0, 0.0]), 5.0, 5.0).tolist()
    [-4.0, -3.0, 0.0]
    """
    way = end - start
    length = float(np.linalg.norm(way))
    reachable = length < upper + lower
    along = (
        (length**2 + upper**2 - lower**2) / (2 * length) if reachable else length * upper / (upper + lower)
    )
    height = float(np.sqrt(max(upper**2 - along**2, 0.0))) if reachable else 0.0
    out = np.array(bend, dtype=np.float64)
    out = out - (out @ way) / length**2 * way
    joint: Floats = start + way / length * along + out / np.linalg.norm(out) * height
    return joint


def factors(rng: np.random.Generator, spread: float, *names: str) -> dict[str, float]:
    """Draw a factor from ``1 - spread`` to ``1 + spread`` for each name."""
    return {name: float(rng.uniform(1 - spread, 1 + spread)) for name in names}
