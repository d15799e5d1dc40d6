"""Procedural animals, the default meshes: smooth-blended implicit surfaces, seeded, no two alike."""

from normalgan.rendering.animals.animal import Animal, herd
from normalgan.rendering.animals.kinds import GROUPS, SPECIES

__all__ = ["GROUPS", "SPECIES", "Animal", "herd"]
