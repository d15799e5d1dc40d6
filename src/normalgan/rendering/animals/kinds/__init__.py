"""The species, each a set of numbers; a new one is a new constant here and its name in the table."""

from collections.abc import Mapping
from types import MappingProxyType

from normalgan.rendering.animals.kinds.bear import BEAR
from normalgan.rendering.animals.kinds.canines import DOG, FOX
from normalgan.rendering.animals.kinds.farm import COW, HORSE, PIG
from normalgan.rendering.animals.kinds.felines import CAT, LION
from normalgan.rendering.animals.kinds.flock import GOAT, SHEEP
from normalgan.rendering.animals.kinds.giants import ELEPHANT, RHINO
from normalgan.rendering.animals.kinds.wild import CAMEL, GIRAFFE, STAG
from normalgan.rendering.animals.species import Species

SPECIES: Mapping[str, Species] = MappingProxyType(
    {
        "bear": BEAR,
        "camel": CAMEL,
        "cat": CAT,
        "cow": COW,
        "dog": DOG,
        "elephant": ELEPHANT,
        "fox": FOX,
        "giraffe": GIRAFFE,
        "goat": GOAT,
        "horse": HORSE,
        "lion": LION,
        "pig": PIG,
        "rhino": RHINO,
        "sheep": SHEEP,
        "stag": STAG,
    }
)

__all__ = ["SPECIES"]
