"""The birds by name."""

from collections.abc import Mapping

from normalgan.animals.birds import bird
from normalgan.animals.kinds.birds_tree import EAGLE, OWL, PARROT, SONGBIRD
from normalgan.animals.kinds.birds_water import DUCK, FLAMINGO, HEN, HERON, SWAN
from normalgan.animals.plan import BodyPlan

BIRDS: Mapping[str, BodyPlan] = {
    "songbird": bird(SONGBIRD),
    "duck": bird(DUCK),
    "swan": bird(SWAN),
    "hen": bird(HEN),
    "heron": bird(HERON),
    "flamingo": bird(FLAMINGO),
    "owl": bird(OWL),
    "eagle": bird(EAGLE),
    "parrot": bird(PARROT),
}
