"""The fish by name."""

from collections.abc import Mapping

from normalgan.animals.fishes import fish
from normalgan.animals.kinds.fish_round import ANGELFISH, CARP, PERCH, PUFFER
from normalgan.animals.kinds.fish_sea import RAY, SHARK, SWORDFISH, TUNA
from normalgan.animals.plan import BodyPlan

FISH: Mapping[str, BodyPlan] = {
    "perch": fish(PERCH),
    "carp": fish(CARP),
    "shark": fish(SHARK),
    "tuna": fish(TUNA),
    "swordfish": fish(SWORDFISH),
    "angelfish": fish(ANGELFISH),
    "pufferfish": fish(PUFFER),
    "ray": fish(RAY),
}
