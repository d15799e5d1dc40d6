"""Procedural animals, the default meshes: smooth-blended implicit surfaces, seeded, no two alike."""

from normalgan.animals.animal import Animal, herd
from normalgan.animals.kinds import GROUPS, SPECIES

__all__ = ["GROUPS", "SPECIES", "Animal", "herd"]
