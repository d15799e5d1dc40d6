"""Varied: an individual of any mesh source, itself a mesh source."""

import hashlib
import json
from dataclasses import asdict, dataclass, replace

from normalgan.ranges import Count, check_ranges
from normalgan.rendering.mesh import Mesh, MeshSource
from normalgan.rendering.variation.variation import Variation
from normalgan.rendering.variation.vary import vary
from normalgan.seeds import rng_of

__all__ = ["VARIATION_VERSION", "Varied"]

VARIATION_VERSION = 1
"""Part of every fingerprint; raise it when a number gives another individual than before."""


@dataclass(frozen=True)
class Varied:
    """An individual of a mesh, drawn by its number; a `MeshSource`.

    Args:
        source: where the mesh is from.
        variation: how far individuals differ.
        number: number of the individual, from 0; the variant depends only on it and the mesh's name.

    Raises:
        InputError: if the number is negative.
    """

    source: MeshSource
    variation: Variation
    number: Count

    def __post_init__(self) -> None:
        check_ranges(self)

    @property
    def name(self) -> str:
        """The source's name, and the number: ``horse~1``, or ``horse@3~1`` of a pose."""
        return f"{self.source.name}~{self.number}"

    def fingerprint(self) -> str:
        """Return a hash of the source's fingerprint, the strengths and the number.

        Raises:
            InputError: if the source cannot be read.
        """
        parts = [VARIATION_VERSION, self.source.fingerprint(), self.name, asdict(self.variation), self.number]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def load(self) -> Mesh:
        """Return the individual.

        Raises:
            InputError: if the source cannot be used.
        """
        rng = rng_of(self.source.name, self.number)
        return replace(vary(self.source.load(), self.variation, rng), name=self.name)
