"""The random numbers of one variation, drawn once; strengths then say how much they count."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles

__all__ = ["BUMPS", "PARTS", "VariationDraws", "draw"]

PARTS, BUMPS = 3, 12


@dataclass(frozen=True)
class VariationDraws:
    """Unit-scale random draws for one variation, before strengths are applied.

    Args:
        scale: (3,) in [-1, 1], as are all but the last three.
        taper: ().
        bend: (2,) up or down, and sideways.
        twist: ().
        limbs: (2,) length and thickness.
        parts: (3,) growth of the parts.
        bumps: (12,) heights of the bumps.
        part_places: (3,) positions of the parts, as shares of the surface in [0, 1].
        bump_places: (12,) the same of the bumps.
        widths: (15,) in [0, 1], of the parts, then of the bumps.
        lattice: (4, 4, 4, 3) normally distributed, cut off at ±2.
    """

    scale: Doubles
    taper: float
    bend: Doubles
    twist: float
    limbs: Doubles
    parts: Doubles
    bumps: Doubles
    part_places: Doubles
    bump_places: Doubles
    widths: Doubles
    lattice: Doubles


def draw(rng: np.random.Generator) -> VariationDraws:
    """Return new draws: always equally many, so that no strength shifts another's."""
    return VariationDraws(
        scale=rng.uniform(-1, 1, 3),
        taper=float(rng.uniform(-1, 1)),
        bend=rng.uniform(-1, 1, 2),
        twist=float(rng.uniform(-1, 1)),
        limbs=rng.uniform(-1, 1, 2),
        parts=rng.uniform(-1, 1, PARTS),
        bumps=rng.uniform(-1, 1, BUMPS),
        part_places=rng.uniform(0, 1, PARTS),
        bump_places=rng.uniform(0, 1, BUMPS),
        widths=rng.uniform(0, 1, PARTS + BUMPS),
        lattice=rng.standard_normal((4, 4, 4, 3)).clip(-2, 2),
    )
