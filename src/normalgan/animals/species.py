"""The species by name and group: files of the folder beside, read when asked for, and functions."""

from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType

from normalgan.animals.insects import INSECTS
from normalgan.animals.objects import BLOBS
from normalgan.animals.plan import BodyPlan
from normalgan.animals.plush import PLUSH
from normalgan.animals.species_files import FOLDER, read_species

__all__ = ["GROUPS", "SPECIES"]

# What a herd of a given seed holds follows from the order: new names go last.
_FILES: Mapping[str, tuple[str, ...]] = {
    "quadrupeds": (
        *("bear", "camel", "cat", "cow", "dog", "elephant", "fox", "giraffe", "goat", "horse", "lion", "pig"),
        *("rhino", "sheep", "stag"),
    ),
    "birds": ("songbird", "duck", "swan", "hen", "heron", "flamingo", "owl", "eagle", "parrot"),
    "fish": ("perch", "carp", "shark", "tuna", "swordfish", "angelfish", "pufferfish", "ray"),
    "reptiles": ("lizard", "iguana", "crocodile", "tortoise", "seaturtle", "snake", "cobra"),
    "dinosaurs": ("tyrannosaur", "raptor", "spinosaur", "sauropod", "stegosaur", "triceratops"),
    "bipeds": ("adult", "cartoon", "child", "gorilla", "heavy", "monkey", "robot", "standing_bear"),
}
_FUNCTIONS: Mapping[str, Mapping[str, BodyPlan]] = {"insects": INSECTS, "plush": PLUSH, "blobs": BLOBS}

GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {**_FILES, **{group: tuple(table) for group, table in _FUNCTIONS.items()}}
)
"""The names of the species of each group; a new species of a file is its name here and the file."""


class _Species(Mapping[str, BodyPlan]):
    """All species by name, in the order of the groups; a file is read when its species is asked for."""

    def __init__(self) -> None:
        self._group = {name: group for group, names in GROUPS.items() for name in names}

    def __getitem__(self, name: str) -> BodyPlan:
        """Return the body plan of a species."""
        group = self._group[name]
        return _FUNCTIONS[group][name] if group in _FUNCTIONS else _read(group, name)

    def __iter__(self) -> Iterator[str]:
        """Go over the names."""
        return iter(self._group)

    def __len__(self) -> int:
        """Return how many species there are."""
        return len(self._group)

    def __contains__(self, name: object) -> bool:
        """Return whether there is such a species, without reading it."""
        return name in self._group


@cache
def _read(group: str, name: str) -> BodyPlan:
    return read_species(FOLDER / group / f"{name}.toml")


SPECIES: Mapping[str, BodyPlan] = _Species()
"""All species by name; no two groups share one."""
