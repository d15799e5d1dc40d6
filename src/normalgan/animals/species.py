"""Species by name and group: functions, and TOML files next to this module that are read on demand.

The fields of a file are those of a body plan, which are explained in its docstring.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from normalgan.animals.insects import INSECTS
from normalgan.animals.objects import BLOBS
from normalgan.animals.plan import BodyPlan
from normalgan.animals.plush import PLUSH
from normalgan.animals.tables import FOLDER, read_toml
from normalgan.errors import InputError, did_you_mean
from normalgan.records import read_record

PLANS = {
    "biped": "normalgan.animals.bipeds.Biped",
    "bird": "normalgan.animals.birds.Bird",
    "crawler": "normalgan.animals.reptiles.Crawler",
    "fish": "normalgan.animals.fish.Fish",
    "quadruped": "normalgan.animals.quadrupeds.Quadruped",
    "snake": "normalgan.animals.reptiles.Snake",
    "theropod": "normalgan.animals.dinosaurs.Theropod",
    "turtle": "normalgan.animals.reptiles.Turtle",
}
"""Body plans that a file may name as its ``plan``, with their modules, which are imported on demand."""
# The order determines the animals for a given seed, so new names must be appended.
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
"""The names of the species of each group. To add a species, add its name here and its file."""


class _Species(Mapping[str, BodyPlan]):
    """All species by name, in the order of the groups; files are read on demand."""

    def __init__(self) -> None:
        self._group = {name: group for group, names in GROUPS.items() for name in names}

    def __getitem__(self, name: str) -> BodyPlan:
        """Return the body plan of a species."""
        group = self._group[name]
        return _FUNCTIONS[group][name] if group in _FUNCTIONS else _read(group, name)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._group)

    def __len__(self) -> int:
        """Return the number of species."""
        return len(self._group)

    def __contains__(self, name: object) -> bool:
        """Return whether there is a species of this name, without reading its file."""
        return name in self._group


@cache
def _read(group: str, name: str) -> BodyPlan:
    return read_species(FOLDER / group / f"{name}.toml")


SPECIES: Mapping[str, BodyPlan] = _Species()
"""All species by name; each belongs to one group only."""


def read_species(path: str | Path) -> BodyPlan:
    """Return the species that a TOML file describes.

    ``plan`` names a body plan. The other keys are the fields of that class, and tables are the fields of
    nested classes. A string instead of a table names an entry of `SHARED`. Where there are several kinds,
    ``kind`` in the table selects one.

    Args:
        path: path of the file; the files of the package in `FOLDER` are examples.

    Raises:
        InputError: if the file cannot be read, is not TOML, or has a missing, unknown or invalid field.

    Example:
        >>> read_species(FOLDER / "quadrupeds" / "horse.toml").poses[:5]
        ('stand', 'walk', 'trot', 'gallop', 'graze')
    """
    table = read_toml(Path(path))
    name = str(table.pop("plan", "missing"))
    try:
        if name not in PLANS:
            known = ", ".join(PLANS)
            raise InputError(f"plan is {name}.{did_you_mean(name, PLANS)} Known: {known}.")
        module, _, cls = PLANS[name].rpartition(".")
        plan: BodyPlan = read_record(getattr(import_module(module), cls), table)
        if not table["habits"]:
            raise InputError("habits name one pose or more.")
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return plan
