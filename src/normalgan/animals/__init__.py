"""Procedural animals, the default meshes: smooth-blended implicit surfaces, seeded, no two alike."""

from normalgan.animals.animal import Animal, herd
from normalgan.animals.species import GROUPS, SPECIES, read_species

__all__ = ["GROUPS", "SPECIES", "Animal", "herd", "read_species"]
