"""ClassSpec: a registered class with plain settings, as files from anywhere may name it."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, TypeVar

from jsonargparse import ArgumentParser

from normalgan.errors import FOREIGN_ERRORS, InputError, brief
from normalgan.files.limits import MOST_DEPTH, MOST_NODES
from normalgan.models.base import Network
from normalgan.registry import Registry, class_path
from normalgan.weights.local_classes import find_local, where_classes_are_looked_for

__all__ = ["ANY_NUMBER", "LARGEST", "ClassSpec", "is_plain"]

T = TypeVar("T")

LARGEST = 4096
"""No width, depth or size of a network is larger; what is, was made up to take all time or memory."""
ANY_NUMBER = 2**63
"""Bound of settings that take no memory, such as the weight of a loss."""


@dataclass(frozen=True)
class ClassSpec:
    """A class and its settings.

    Args:
        name: name of a registered class, or its dotted path; see `Registry.find`.
        settings: its settings, by name.
    """

    name: str
    settings: Mapping[str, Any]

    @classmethod
    def of(cls, configuration: Any, largest: int = LARGEST) -> "ClassSpec":
        """Return the part that a configuration names; nothing in it is looked up yet.

        Args:
            configuration: with ``class_path`` and ``init_args``, as checkpoints have it.
            largest: number that a setting may be.

        Raises:
            InputError: if it has other content.

        >>> ClassSpec.of({"class_path": "normalgan.hints.UniformHints", "init_args": {"minimum": 1}})
        ClassSpec(name='normalgan.hints.UniformHints', settings={'minimum': 1})
        """
        if not isinstance(configuration, Mapping) or not configuration.keys() <= {"class_path", "init_args"}:
            raise InputError("what it names is not a class with settings.")
        name, settings = configuration.get("class_path"), configuration.get("init_args")
        settings = {} if settings is None else settings
        if not isinstance(name, str) or not isinstance(settings, dict):
            raise InputError("what it names is not a class with settings.")
        for key, value in settings.items():
            if not is_plain(value, largest):
                raise InputError(
                    f"{str(key)[:40]} of {name[:40]} is {_shown(value)}, but settings that a model brings "
                    f"are numbers up to {largest}, words, true, false, null, or lists of these."
                )
        return cls(name, {str(key): _lists(value) for key, value in settings.items()})

    @classmethod
    def of_object(cls, built: object) -> "ClassSpec | None":
        """Return the arguments that an object was built with, None if they are not plain values."""
        if is_dataclass(built) and not isinstance(built, type):
            settings = {field.name: getattr(built, field.name) for field in fields(built) if field.init}
        elif isinstance(built, Network):
            settings = dict(built.built_with)
        else:
            return None
        if not all(is_plain(value, ANY_NUMBER) for value in settings.values()):
            return None
        kind = type(built)
        return cls(class_path(kind), {k: _lists(v) for k, v in settings.items()})

    def to_dict(self) -> dict[str, Any]:
        """Return the part as a configuration names it, by its own name."""
        return {"class_path": self.name, "init_args": dict(self.settings)}

    def to_json(self) -> str:
        """Return the part as JSON."""
        return json.dumps(self.to_dict())

    @classmethod
    def from_json(cls, text: str) -> "ClassSpec":
        """Return the part that a text names; nothing in it is looked up yet.

        Raises:
            InputError: if the text has other content.
        """
        try:
            return cls.of(json.loads(text, parse_constant=float))
        except (ValueError, RecursionError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError("what it names is not a class with settings.") from None

    def configuration(self, registry: Registry[Any]) -> dict[str, Any]:
        """Return the part as a configuration names it, by the full name of the class.

        Raises:
            InputError: if neither the registry, plug-ins included, nor the working directory has the class.
        """
        known = registry.find(self.name) or find_local(self.name, registry.base)
        if known is None:
            name = self.name[:60]
            raise InputError(registry.explain_unknown(name) + where_classes_are_looked_for(name))
        return {**self.to_dict(), "class_path": class_path(known)}

    def build(self, registry: Registry[T]) -> T:
        """Return an instance of the class.

        Raises:
            InputError: if there is no such class, or it does not take these settings.
        """
        parser = ArgumentParser(exit_on_error=False)
        parser.add_argument("--part", type=registry.base)
        configuration = self.configuration(registry)
        try:
            built: T = parser.instantiate(parser.parse_object({"part": configuration})).part
        except FOREIGN_ERRORS as error:  # a class of anybody's, given settings of anybody's
            raise InputError(f"{self.name} does not take its settings: {brief(error)}") from error
        return built


def is_plain(value: Any, largest: int = LARGEST) -> bool:
    """Return whether a setting is plain data: a dotted path might import a module.

    >>> is_plain([0.5, "batch", None]), is_plain("os.system"), is_plain({"class_path": "a"}), is_plain(5000)
    (True, False, False, False)
    """
    waiting, counted = [(value, 0)], 0
    while waiting:
        item, depth = waiting.pop()
        counted += 1
        if counted > MOST_NODES or depth > MOST_DEPTH:  # lists in a pickle can hold one another many times
            return False
        if isinstance(item, list | tuple):
            waiting += [(inner, depth + 1) for inner in item]
        elif isinstance(item, str):
            if not re.fullmatch(r"[\w+-]{0,100}", item):
                return False
        elif item is not None and not (isinstance(item, int | float) and -largest <= item <= largest):
            return False  # nor is nan
    return True


def _lists(value: Any) -> Any:
    """Return tuples as lists, as YAML has them."""
    return [_lists(item) for item in value] if isinstance(value, list | tuple) else value


def _shown(value: Any) -> str:
    """Describe a value briefly; it may be very long."""
    if isinstance(value, int) and abs(value) > 10**1000:
        return "an endless number"
    if isinstance(value, str):
        return ascii(value)[1:41]
    return str(value)[:40] if isinstance(value, int | float) else f"a {type(value).__name__}"
