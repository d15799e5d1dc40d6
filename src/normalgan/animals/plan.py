"""Body plans: the interface of all species, which turn random numbers into parts."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from normalgan.animals.parts import Part
from normalgan.animals.tables import Number, Point, Span, Table

Rng = np.random.Generator


@dataclass(frozen=True)
class Eyeball(Table):
    """The right eye of a pair.

    Args:
        at: centre of the eyeball.
        radius: radius of the eyeball.
    """

    at: Point
    radius: Number


class BodyPlan(Protocol):
    """A species, with the head towards +x, +y up, the animal's right at +z, in any unit of length."""

    @property
    def poses(self) -> tuple[str, ...]:
        """The names of the poses that can be requested."""

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in blending order.

        Args:
            pose: one of `poses`; None for a random pose.
            rng: source of randomness for proportions, age, carriage, and the pose unless one is given.
        """


@dataclass(frozen=True)
class PosedPlan(Table, ABC):
    """Base class of most body plans, where the pose is drawn first and determines everything else.

    Args:
        habits: poses of the species; a pose listed twice is drawn twice as often.
    """

    habits: tuple[str, ...]

    @property
    def poses(self) -> tuple[str, ...]:
        """The habits without duplicates."""
        return tuple(dict.fromkeys(self.habits))

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return the parts of a random individual."""
        return self.assemble(drawn_pose(self.habits, pose, rng), rng)

    @abstractmethod
    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose, in blending order."""


@dataclass(frozen=True)
class FunctionPlan(PosedPlan):
    """A species defined by a function of the pose and a random generator.

    Args:
        shape: function that returns the parts of a random individual.
    """

    shape: Callable[[str, Rng], list[Part]]

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        return self.shape(pose, rng)


def drawn_pose(habits: Sequence[str], pose: str | None, rng: Rng) -> str:
    """Return the requested pose or a random habit; the random number is drawn in both cases."""
    drawn = str(rng.choice(habits))
    return pose or drawn


def proportions(
    general: Mapping[str, Span], own: Mapping[str, Span], rng: Rng, young: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Return random factors by which an individual differs from its species.

    Args:
        general: default range of each factor in the body plan.
        own: ranges of the species that differ from the default.
        rng: random generator; factors are uniform and drawn in the order of ``general``.
        young: factors of a young animal; None for an adult.

    >>> proportions({"legs": (1.0, 1.0), "tail": (0.8, 1.2)}, {"tail": (2.0, 2.0)}, np.random.default_rng(0))
    {'legs': 1.0, 'tail': 2.0}
    """
    drawn = {name: rng.uniform(*own.get(name, span)) for name, span in general.items()}
    return {name: value * (young or {}).get(name, 1.0) for name, value in drawn.items()}


def around(rng: Rng, spread: float, *usual: float) -> list[float]:
    """Return random numbers that differ from the usual ones by a fraction of at most ``spread``."""
    return [value * rng.uniform(1 - spread, 1 + spread) for value in usual]
