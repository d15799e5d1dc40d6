"""Animals by species and number, and herds of them: the data the package brings along."""

import difflib
import hashlib
import zlib
from dataclasses import dataclass

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.animals.kinds import SPECIES
from normalgan.rendering.animals.meshing import to_mesh
from normalgan.rendering.animals.pose import POSES
from normalgan.rendering.animals.quadruped import assemble
from normalgan.rendering.animals.species import draw_build
from normalgan.rendering.mesh import Mesh

VERSION = 1  # to be raised whenever the same species and seed give another shape
YOUNG_SHARE = 0.12


@dataclass(frozen=True)
class Animal:
    """A procedural quadruped; no two seeds give the same one.

    Args:
        species: such as horse, stag, cat.
        seed: draws proportions, age and carriage, and the pose if none is given; not negative.
        pose: stand, walk, trot, gallop, graze or sit; drawn from those of the species if None.

    Raises:
        InputError: if species, seed or pose is not such.

    Example:
        >>> Animal("horse", 7).name
        'horse-0007'
    """

    species: str
    seed: int
    pose: str | None = None

    def __post_init__(self) -> None:
        """Check what the user wrote, at once and not in a worker process."""
        _known("species", self.species, list(SPECIES))
        if self.pose is not None:
            _known("pose", self.pose, list(POSES))
        if self.seed < 0:
            raise InputError(f"an animal's seed is a whole number from 0 on, not {self.seed}.")

    @property
    def name(self) -> str:
        """Species and seed, and the pose if it was asked for."""
        return f"{self.species}-{self.seed:04d}" + (f"-{self.pose}" if self.pose else "")

    def fingerprint(self) -> str:
        """Return a hash of the parameters and the version of the generator."""
        text = f"animal {VERSION} {self.species} {self.seed} {self.pose}"
        return hashlib.sha256(text.encode()).hexdigest()

    def load(self) -> Mesh:
        """Return the mesh, always the same for the same animal; takes about a second."""
        kind = SPECIES[self.species]
        rng = np.random.default_rng([zlib.crc32(self.species.encode()), self.seed])
        build = draw_build(kind.ranges, bool(rng.uniform() < YOUNG_SHARE), rng)
        drawn = str(rng.choice(kind.poses))
        pose = POSES[self.pose or drawn](rng)
        return to_mesh(self.name, assemble(kind, build, pose, rng))


def herd(count: int, seed: int = 0) -> list[Animal]:
    """Return ``count`` animals, the species in rotation; the same for the same seed.

    Animals of different herd seeds differ, and a longer herd begins with the shorter one.

    >>> [animal.species for animal in herd(3, seed=0)] == list(SPECIES)[:3]
    True
    """
    if count < 1:
        raise InputError(f"a herd has at least one animal, not {count}.")
    names = list(SPECIES)
    return [Animal(names[i % len(names)], seed * 10_000 + i // len(names)) for i in range(count)]


def _known(what: str, name: str, names: list[str]) -> None:
    if name not in names:
        near = difflib.get_close_matches(name.lower(), names, n=1, cutoff=0.5)
        hint = f" Did you mean {near[0]}?" if near else ""
        raise InputError(f"no {what} named {name!r}.{hint} Known: {', '.join(names)}.")
