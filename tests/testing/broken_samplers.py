"""Hint samplers with a fault each, and the sentence that the kit is to say of it."""

import random
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor

from normalgan.hints import HintSampler


class Right(HintSampler):
    """Gives every fourth pixel of the object, as it should."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = torch.zeros_like(normal[:, :1])
        where[..., ::2, ::2] = 1
        return where * mask


class Flat(Right):
    """Forgets the channel."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng)[:, 0]


class ListOfThem(Right):
    """Returns a list."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Any:
        return list(super().sample(normal, mask, rng))


class Whole(Right):
    """Returns whole numbers."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng).long()


class Half(Right):
    """Returns half a hint."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng) / 2


class Everywhere(Right):
    """Forgets the mask."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return torch.ones_like(mask)


class AtLeastOne(Right):
    """Gives a picture without an object a hint."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = super().sample(normal, mask, rng)
        where[:, 0, 0, 0] = torch.where(mask.sum((1, 2, 3)) > 0, where[:, 0, 0, 0], 1)
        return where


class Divides(Right):
    """Fails where there is no object."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        for one in mask:
            _ = 1 / int(one.sum())
        return super().sample(normal, mask, rng)


class Square(Right):
    """Knows only square pictures."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng) * torch.ones(mask.shape[-1], mask.shape[-1])


class Moody(Right):
    """Draws by a state of its own."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        own = torch.Generator()
        own.seed()
        return super().sample(normal, mask, rng) * (torch.rand(mask.shape, generator=own) > 0.5)


class Global(Right):
    """Draws from torch's global state, and puts it back to hide that, but not Python's."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        random.seed(1)
        return super().sample(normal, mask, rng)


class Quota(Right):
    """Shares a number of hints among the batch."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = super().sample(normal, mask, rng)
        return where * (where.flatten().cumsum(0).view(where.shape) <= 60)


class Drawing(Right):
    """Draws as many numbers for a picture as it has pixels on the object."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = torch.zeros_like(mask)
        for place, one in zip(where, mask, strict=True):
            place[one > 0] = (torch.rand(int(one.sum()), generator=rng) > 0.5).float()
        return where


class Overwrites(Right):
    """Writes into the mask."""

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where = super().sample(normal, mask, rng)
        mask[..., ::2] = 0
        return where * mask


class Undocumented(Right):
    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        return super().sample(normal, mask, rng)


@dataclass(frozen=True)
class Mysterious(Right):
    """Has a setting that nobody explains."""

    spacing: int = 2


class Untyped(Right):
    """Has a setting without a type.

    Args:
        spacing: between hints.
    """

    def __init__(self, spacing=2) -> None:  # type: ignore[no-untyped-def]
        self.spacing = spacing


@dataclass(frozen=True)
class Holding(Right):
    """Has a setting that YAML cannot hold.

    Args:
        pattern: of hints.
    """

    pattern: Any = field(default_factory=lambda: torch.ones(2))


@dataclass
class Growing(Right):
    """Changes its settings.

    Args:
        spacing: between hints.
    """

    spacing: int = 2

    def __post_init__(self) -> None:
        self.spacing += 1


class Locked(Right):
    """Opens a file that no other process can have."""

    def __init__(self) -> None:
        self.file = open(__file__)  # noqa: PTH123, SIM115

    def __del__(self) -> None:
        self.file.close()


class _Private(Right):
    """Has a name that jsonargparse hides."""


FAULTS = [
    (
        Flat,
        r"Flat returned \(2, 32, 32\) for normals of \(2, 3, 32, 32\); it must return where the hints are",
    ),
    (ListOfThem, "ListOfThem returned list for normals of"),
    (
        Whole,
        r"Whole returned torch.int64 for normals of torch.float32; it must return the type of the normals.",
    ),
    (Half, "Half returned 0.5; a pixel has a hint, 1, or none, 0."),
    (Everywhere, r"Everywhere gave \d+ hints off the object; hints must lie where mask is 1"),
    (AtLeastOne, "AtLeastOne gave 1 hints to a picture without an object; it must give none"),
    (
        Divides,
        "Divides raised ZeroDivisionError .* when asked for pictures without an object; a picture without",
    ),
    (Square, "Square raised RuntimeError .* when asked for batches of other sizes; every size of picture"),
    (Moody, "Moody gave other hints under the same seed; all randomness must come from rng"),
    (
        Global,
        "Global drew from or seeded Python's global random state; all randomness must come from the gen",
    ),
    (
        Quota,
        "Quota changed the hints of a sample when another one of the batch was changed; a sample must not",
    ),
    (Drawing, "Drawing changed the hints of a sample when another one of the batch was changed"),
    (Overwrites, "Overwrites changed the normals or the mask it was given; they belong to the caller"),
    (Undocumented, "Undocumented has no docstring of its own; its first line is what --help"),
    (
        Mysterious,
        "Mysterious does not explain spacing in its docstring; the docstring of the class needs a line",
    ),
    (Untyped, "Untyped has a setting spacing without a type; the command line reads the type"),
    (Holding, "Holding .*; settings must be"),
    (Growing, "Growing built from its own settings is another one; its fields must be its settings"),
    (Locked, "Locked raised TypeError .* when asked for being handed to another process; it must survive"),
    (_Private, "_Private has a part that begins with an underscore in its path"),
]
