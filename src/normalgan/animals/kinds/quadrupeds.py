"""The quadrupeds, each a set of numbers; a new one is a new constant and its name in the table."""

from collections.abc import Mapping

from normalgan.animals.kinds.bear import BEAR
from normalgan.animals.kinds.canines import DOG, FOX
from normalgan.animals.kinds.farm import COW, HORSE, PIG
from normalgan.animals.kinds.felines import CAT, LION
from normalgan.animals.kinds.flock import GOAT, SHEEP
from normalgan.animals.kinds.giants import ELEPHANT, RHINO
from normalgan.animals.kinds.wild import CAMEL, GIRAFFE, STAG
from normalgan.animals.plan import BodyPlan
from normalgan.animals.quadruped import Quadruped

QUADRUPEDS: Mapping[str, BodyPlan] = {
    "bear": Quadruped(BEAR),
    "camel": Quadruped(CAMEL),
    "cat": Quadruped(CAT),
    "cow": Quadruped(COW),
    "dog": Quadruped(DOG),
    "elephant": Quadruped(ELEPHANT),
    "fox": Quadruped(FOX),
    "giraffe": Quadruped(GIRAFFE),
    "goat": Quadruped(GOAT),
    "horse": Quadruped(HORSE),
    "lion": Quadruped(LION),
    "pig": Quadruped(PIG),
    "rhino": Quadruped(RHINO),
    "sheep": Quadruped(SHEEP),
    "stag": Quadruped(STAG),
}
