"""Body plans: the interface of all species, which grow from random numbers into parts."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from normalgan.animals.parts import Part
from normalgan.animals.tables import Number, Point, Span, Table

__all__ = [
    "BodyPlan",
    "Eyeball",
    "Form",
    "PosedPlan",
    "Rng",
    "around",
    "drawn_pose",
    "proportions",
]

Rng = np.random.Generator


@dataclass(frozen=True)
class Eyeball(Table):
    """The right one of a pair of eyes.

    Args:
        at: its middle.
        radius: its radius.
    """

    at: Point
    radius: Number


class BodyPlan(Protocol):
    """A species: head to +x, +y up, the animal's right at +z, in any unit of length."""

    @property
    def poses(self) -> tuple[str, ...]:
        """The names of the poses that can be requested."""

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts, in the order in which they blend.

        Args:
            pose: one of `poses`; None to draw one.
            rng: source of randomness for proportions, age, carriage, and the pose unless one is given.
        """


@dataclass(frozen=True)
class PosedPlan(Table, ABC):
    """The base of most body plans: the pose is drawn first, and everything else follows from it.

    Args:
        habits: the poses it takes; one named twice is drawn twice as often.
    """

    habits: tuple[str, ...]

    @property
    def poses(self) -> tuple[str, ...]:
        """The habits, each once."""
        return tuple(dict.fromkeys(self.habits))

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts."""
        return self.assemble(drawn_pose(self.habits, pose, rng), rng)

    @abstractmethod
    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of one individual in a pose, in the order in which they blend."""


@dataclass(frozen=True)
class Form(PosedPlan):
    """A species made by a function of the pose and a source of random numbers.

    Args:
        shape: returns the parts of one individual.
    """

    shape: Callable[[str, Rng], list[Part]]

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of one individual in a pose."""
        return self.shape(pose, rng)


def drawn_pose(habits: Sequence[str], pose: str | None, rng: Rng) -> str:
    """Return the requested pose, or one of the habits; the draw is made in any case."""
    drawn = str(rng.choice(habits))
    return pose or drawn


def proportions(
    general: Mapping[str, Span], own: Mapping[str, Span], rng: Rng, young: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Draw the factors by which an individual differs from its species.

    Args:
        general: the range of each factor in all species of the body plan.
        own: those ranges of the species that differ.
        rng: draws each factor evenly, in the order of ``general``.
        young: factors of a young animal; None for an adult.

    >>> proportions({"legs": (1.0, 1.0), "tail": (0.8, 1.2)}, {"tail": (2.0, 2.0)}, np.random.default_rng(0))
    {'legs': 1.0, 'tail': 2.0}
    """
    drawn = {name: rng.uniform(*own.get(name, span)) for name, span in general.items()}
    return {name: value * (young or {}).get(name, 1.0) for name, value in drawn.items()}


def around(rng: Rng, spread: float, *usual: float) -> list[float]:
    """Draw a number about each usual one, off it by at most the part ``spread`` of itself."""
    return [value * rng.uniform(1 - spread, 1 + spread) for value in usual]
