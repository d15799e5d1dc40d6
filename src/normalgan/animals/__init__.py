"""Procedural animals, the default meshes: blended implicit surfaces, each generated from a seed."""

from normalgan.animals.animal import Animal, make_animals
from normalgan.animals.species import GROUPS, SPECIES, read_species

__all__ = ["GROUPS", "SPECIES", "Animal", "make_animals", "read_species"]
