"""Generated animals: a single one by species and seed, or many."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

from normalgan.animals.quadrupeds_poses import POSTURES
from normalgan.animals.species import GROUPS, SPECIES
from normalgan.errors import InputError, did_you_mean
from normalgan.ranges import Count, check_ranges
from normalgan.rendering.mesh import Mesh
from normalgan.seeds import rng_of

_VERSION = 2  # increase it if the same species and seed give a different shape than before


@dataclass(frozen=True)
class Animal:
    """A procedural animal, different for each seed.

    Args:
        species: species, such as horse, owl or shark; see `SPECIES`.
        seed: non-negative seed of proportions, age, carriage, and of the pose if none is given.
        pose: a pose of the species, such as stand, walk or sit; None for a random pose.

    Raises:
        InputError: if species, seed or pose is invalid.

    Example:
        >>> Animal("horse", 7).name
        'horse-0007'
    """

    species: str
    seed: Count
    pose: str | None = None

    def __post_init__(self) -> None:
        """Check the settings before a worker process uses them."""
        _known("species", self.species, list(SPECIES))
        if self.pose is not None:
            _known(f"pose of {self.species}", self.pose, list(SPECIES[self.species].poses))
        check_ranges(self)

    @property
    def name(self) -> str:
        """Name from species, seed and, if given, pose."""
        return f"{self.species}-{self.seed:04d}" + (f"-{self.pose}" if self.pose else "")

    def fingerprint(self) -> str:
        """Return a hash of the parameters and the version of the generator."""
        text = f"animal {_VERSION} {self.species} {self.seed} {self.pose}"
        return hashlib.sha256(text.encode()).hexdigest()

    def load(self) -> Mesh:
        """Return the mesh, which is always the same for an animal; this takes about a second."""
        from normalgan.animals.meshing import to_mesh  # takes half a second to import

        rng = rng_of(self.species, self.seed)
        return to_mesh(self.name, SPECIES[self.species].grow(self.pose, rng))


def make_animals(
    count: int, seed: int = 0, species: Sequence[str] = ("quadrupeds",), postures: float = 0.0
) -> list[Animal]:
    """Return ``count`` animals of alternating species, determined by seed and species.

    Different seeds give different animals, and a larger count only appends animals.

    Args:
        count: number of animals.
        seed: seed of the animals.
        species: names of species or groups; a group stands for all of its species.
        postures: fraction of the animals, from 0 to 1, that sit, lie, rear, beg, bow, leap or look back,
            if the species has such a pose. The others take a usual pose.

    Raises:
        InputError: if the count is below 1, there is no species, a name is unknown, or the fraction is not
            from 0 to 1.

    Example:
        >>> [animal.species for animal in make_animals(3, seed=0)]
        ['bear', 'camel', 'cat']
        >>> [animal.species for animal in make_animals(3, species=["horse", "cat"])]
        ['horse', 'cat', 'horse']
    """
    if count < 1:
        raise InputError(f"the number of animals is {count}; it must be 1 or more.")
    if not 0 <= postures <= 1:
        raise InputError(f"the share of postures is {postures}; give a number from 0 to 1.")
    names = _members(species)
    numbered = [(names[i % len(names)], seed * 10_000 + i // len(names)) for i in range(count)]
    return [Animal(name, number, _posture(name, number, postures)) for name, number in numbered]


def _posture(species: str, seed: int, probability: float) -> str | None:
    """Return the posture of an animal, or None for a fraction 1 - ``probability`` of the animals."""
    known = [pose for pose in SPECIES[species].poses if pose == "sit" or pose in POSTURES]
    rng = rng_of(f"posture of {species}", seed)
    return str(rng.choice(known)) if known and rng.random() < probability else None


def _members(names: Sequence[str]) -> list[str]:
    """Return the species for names of species and groups, in order and without duplicates.

    Raises:
        InputError: if there is no name, or a name is unknown.
    """
    if not names:
        raise InputError(f"no species was named; known groups: {', '.join(GROUPS)}.")
    for name in names:
        _known("species or group", name, [*GROUPS, *SPECIES])
    # A duplicate name would otherwise give the same seed twice.
    return list(dict.fromkeys(one for name in names for one in GROUPS.get(name, (name,))))


def _known(what: str, name: str, names: list[str]) -> None:
    if name not in names:
        hint = did_you_mean(name.lower(), names, 0.5)
        raise InputError(f"no {what} named {name!r}.{hint} Known: {', '.join(names)}.")
