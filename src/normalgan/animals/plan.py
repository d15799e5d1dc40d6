"""Body plans: what every species can do, whatever its shape: grow from random numbers into parts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from normalgan.animals.field import Part

Rng = np.random.Generator


class BodyPlan(Protocol):
    """A species: head to +x, +y up, the animal's right at +z, in any unit of length."""

    @property
    def poses(self) -> tuple[str, ...]:
        """The names of the poses that may be asked for."""

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts, in the order in which they blend.

        Args:
            pose: one of `poses`; None to draw one.
            rng: draws proportions, age, carriage, and the pose if none is given.
        """


@dataclass(frozen=True)
class Form:
    """A species made by a function of the pose and a source of random numbers.

    Args:
        habits: the poses that are drawn from; a pose named twice is drawn twice as often.
        shape: returns the parts of one individual.
    """

    habits: tuple[str, ...]
    shape: Callable[[str, Rng], list[Part]]

    @property
    def poses(self) -> tuple[str, ...]:
        """The habits, each once."""
        return tuple(dict.fromkeys(self.habits))

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts; the pose is drawn, needed or not, so that it shifts nothing."""
        drawn = str(rng.choice(self.habits))
        return self.shape(pose or drawn, rng)
