"""The species by name and group: files in the folder next to this module, read on demand, and functions.

A file is TOML, read into the fields of a body plan, whose docstring says what each means.
"""

import inspect
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType, NoneType
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np

from normalgan.animals.insects import INSECTS
from normalgan.animals.objects import BLOBS
from normalgan.animals.plan import GREATEST, BodyPlan
from normalgan.animals.plush import PLUSH
from normalgan.arrays import Doubles
from normalgan.errors import InputError, brief, did_you_mean
from normalgan.files.limits import read_named
from normalgan.ranges import check_ranges

__all__ = ["FOLDER", "GROUPS", "PLANS", "SHARED", "SPECIES", "read_species"]

FOLDER = Path(__file__).with_name("species")
SHARED = FOLDER / "shared.toml"
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
"""What a file may name as its ``plan``, and where that is; imported when a species of it is read."""
_WORDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
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


def read_species(path: str | Path) -> BodyPlan:
    """Return the species that a TOML file describes.

    The file's ``plan`` names a body plan; its other keys are the fields of that class, tables those of the
    classes within. A string instead of a table names an entry of `SHARED`; where there are several kinds, the
    table's ``kind`` says which.

    Args:
        path: path of the file; those of the package, in `FOLDER`, are examples.

    Raises:
        InputError: if the file cannot be read, is not TOML, or has a missing, unknown or wrong field.

    Example:
        >>> read_species(FOLDER / "quadrupeds" / "horse.toml").poses[:5]
        ('stand', 'walk', 'trot', 'gallop', 'graze')
    """
    table = _toml(Path(path))
    try:
        if "plan" not in table:
            raise InputError(f"plan is missing. Known: {', '.join(PLANS)}.")
        name = _value(table.pop("plan"), Annotated[str, tuple(PLANS)], "plan")
        module, _, cls = PLANS[name].rpartition(".")
        plan: BodyPlan = _record(table, getattr(import_module(module), cls), "")
        if not table.get("habits", True):
            raise InputError("habits name one pose or more.")
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return plan


@cache
def _shared() -> dict[str, Any]:
    return _toml(SHARED)


def _toml(path: Path) -> dict[str, Any]:
    content = read_named(path)
    try:
        return tomllib.loads(content.decode("utf-8"))
    except ValueError as error:  # tomllib's, or of bytes that are not UTF-8
        raise InputError(f"{path} is not a species file, which is TOML: {brief(error)}.") from error


def _value(given: object, hint: Any, where: str) -> Any:
    """Convert a value to the annotated type."""
    if get_origin(hint) is Annotated:
        base, mark = get_args(hint)
        if isinstance(mark, dict):  # what makes a thing of each kind
            return _of_kind(given, mark, where)
        value = _value(given, base, where)
        if isinstance(mark, tuple) and value not in mark:
            known = ", ".join(sorted(mark))
            raise InputError(f"{where} is {_shown(value)}.{did_you_mean(value, mark)} Known: {known}.")
        return value  # a number's range is checked with the object that it is of
    if hint == Doubles:  # by name: what an array's annotation is made of differs between versions of numpy
        return _column(given, where)
    if get_origin(hint) is None:
        return _plain(given, hint, where) if hint in _WORDS else _record(given, hint, where)
    if get_origin(hint) is tuple:
        return _tuple(given, get_args(hint), where)
    if get_origin(hint) is Mapping:
        if not isinstance(given, dict):
            raise InputError(f"{where} is a table, not {_shown(given)}.")
        key, item = get_args(hint)
        return {_value(k, key, where): _value(v, item, f"{where}.{k}") for k, v in given.items()}
    (needed,) = set(get_args(hint)) - {NoneType}
    return _value(given, needed, where)


def _plain(given: object, kind: type, where: str) -> Any:
    right = isinstance(given, int | float if kind is float else kind)
    if not right or (isinstance(given, bool) and kind is not bool):
        raise InputError(f"{where} is {_WORDS[kind]}, not {_shown(given)}.")
    if isinstance(given, int | float) and not abs(given) <= GREATEST:
        raise InputError(f"{where} is a number from -{GREATEST} to {GREATEST}, not {_shown(given)}.")
    return kind(given)


def _column(given: object, where: str) -> Any:
    numbers = _tuple(given, (float, ...), where)
    column = np.array(numbers, dtype=np.float64)
    column.flags.writeable = False  # all individuals share it
    return column


def _tuple(given: object, hints: tuple[Any, ...], where: str) -> tuple[Any, ...]:
    if not isinstance(given, list):
        raise InputError(f"{where} is a list, not {_shown(given)}.")
    if hints[-1] is Ellipsis:
        hints = hints[:1] * len(given)
    if len(given) != len(hints):
        raise InputError(f"{where} is a list of {len(hints)}, not of {len(given)}.")
    items = enumerate(zip(given, hints, strict=True), start=1)
    return tuple(_value(item, hint, f"{where}[{i}]") for i, (item, hint) in items)


def _of_kind(given: object, kinds: dict[str, Any], where: str) -> Any:
    """Build an object of the kind that the table names, or of the first kind."""
    first = next(iter(kinds))
    kind = given.pop("kind", first) if isinstance(given, dict) else first
    return _record(given, kinds[_value(kind, Annotated[str, tuple(kinds)], f"{where}.kind")], where)


def _record(given: object, cls: Any, where: str) -> Any:
    """Build an object from a table, or from a shared table given by name."""
    if isinstance(given, str):
        shared = _shared().get(cls.__name__, {})
        given = shared[_value(given, Annotated[str, tuple(shared)], where)]
    if not isinstance(given, dict):
        raise InputError(f"{where} is a table, not {_shown(given)}.")
    dot = f"{where}." if where else ""
    parameters, hints = _fields(cls)
    for name in given:
        if name not in parameters:
            hint = did_you_mean(name, parameters)
            raise InputError(f"{dot}{name} is not known.{hint} Known: {', '.join(parameters)}.")
    required = [each.name for each in parameters.values() if each.default is each.empty]
    missing = [name for name in required if name not in given]
    if missing:
        raise InputError(f"{dot}{missing[0]} is missing.")
    values = {name: _value(value, hints[name], f"{dot}{name}") for name, value in given.items()}
    try:
        made = cls(**values)
        check_ranges(made)
    except InputError as error:
        raise InputError(f"{where}: {error}" if where else str(error)) from error
    return made


@cache
def _fields(cls: Any) -> tuple[Mapping[str, inspect.Parameter], dict[str, Any]]:
    return inspect.signature(cls).parameters, get_type_hints(cls, include_extras=True)


def _shown(given: object) -> str:
    text = repr(given) if not isinstance(given, dict) else "a table"
    return text if len(text) < 60 else f"{text[:56]}…"
