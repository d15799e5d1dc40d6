"""The species by group; a new group is a table of its own module and a line here."""

from collections.abc import Mapping
from types import MappingProxyType

from normalgan.animals.kinds.bipeds import BIPEDS
from normalgan.animals.kinds.birds import BIRDS
from normalgan.animals.kinds.blobs import BLOBS
from normalgan.animals.kinds.dinosaurs import DINOSAURS
from normalgan.animals.kinds.fish import FISH
from normalgan.animals.kinds.insects import INSECTS
from normalgan.animals.kinds.plush import PLUSH
from normalgan.animals.kinds.quadrupeds import QUADRUPEDS
from normalgan.animals.kinds.reptiles import REPTILES
from normalgan.animals.plan import BodyPlan

_TABLES: Mapping[str, Mapping[str, BodyPlan]] = {
    "quadrupeds": QUADRUPEDS,
    "birds": BIRDS,
    "fish": FISH,
    "reptiles": REPTILES,
    "dinosaurs": DINOSAURS,
    "bipeds": BIPEDS,
    "insects": INSECTS,
    "plush": PLUSH,
    "blobs": BLOBS,
}

GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType({name: tuple(t) for name, t in _TABLES.items()})
"""The names of the species of each group."""

SPECIES: Mapping[str, BodyPlan] = MappingProxyType(
    {name: plan for table in _TABLES.values() for name, plan in table.items()}
)
"""All species by name; no two groups share one."""

__all__ = ["GROUPS", "SPECIES"]
