"""ClassSpec: a registered class with plain settings, as it may appear in untrusted files."""

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

T = TypeVar("T")

LARGEST_SETTING = 4096
"""Upper bound of a network's settings, such as width or size; larger values could exhaust time or memory."""
ANY_NUMBER = 2**63
"""Upper bound of settings that do not affect memory, such as the weight of a loss."""


@dataclass(frozen=True)
class ClassSpec:
    """A class and its settings.

    Args:
        name: name or dotted path of a registered class; see `Registry.find`.
        settings: settings of the class by name.
    """

    name: str
    settings: Mapping[str, Any]

    @classmethod
    def of(cls, configuration: Any, largest: int = LARGEST_SETTING) -> "ClassSpec":
        """Return the class and settings in a configuration, without looking up the class.

        Args:
            configuration: mapping with ``class_path`` and ``init_args``, as in checkpoints.
            largest: largest accepted number in the settings.

        Raises:
            InputError: if ``configuration`` is not such a mapping.

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
        """Return the class and arguments of an object, or None if the arguments are not plain values."""
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
        """Return the configuration, with the class as named here."""
        return {"class_path": self.name, "init_args": dict(self.settings)}

    def to_json(self) -> str:
        """Return the configuration as JSON."""
        return json.dumps(self.to_dict())

    @classmethod
    def from_json(cls, text: str) -> "ClassSpec":
        """Return the class and settings in a JSON text, without looking up the class.

        Raises:
            InputError: if the text has other content.
        """
        try:
            return cls.of(json.loads(text, parse_constant=float))
        except (ValueError, RecursionError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError("what it names is not a class with settings.") from None

    def find(self, registry: Registry[T]) -> type[T]:
        """Return the class.

        Raises:
            InputError: if it is neither registered (including plug-ins) nor in the working directory.
        """
        known = registry.find(self.name) or find_local(self.name, registry.base)
        if known is None:
            name = self.name[:60]
            raise InputError(registry.explain_unknown(name) + where_classes_are_looked_for(name))
        return known

    def configuration(self, registry: Registry[Any]) -> dict[str, Any]:
        """Return the configuration, with the full path of the class; raises `InputError` like `find`."""
        return {**self.to_dict(), "class_path": class_path(self.find(registry))}

    def build(self, registry: Registry[T]) -> T:
        """Return an instance of the class.

        Raises:
            InputError: if there is no such class, or it does not accept these settings.
        """
        parser = ArgumentParser(exit_on_error=False)
        parser.add_argument("--part", type=registry.base)
        configuration = self.configuration(registry)
        try:
            built: T = parser.instantiate(parser.parse_object({"part": configuration})).part
        except FOREIGN_ERRORS as error:  # any class, with any settings, may raise anything
            raise InputError(f"{self.name} does not take its settings: {brief(error)}") from error
        return built


def is_plain(value: Any, largest: int = LARGEST_SETTING) -> bool:
    """Return whether a setting is plain data; a dotted path is not, because it might import a module.

    >>> is_plain([0.5, "batch", None]), is_plain("os.system"), is_plain({"class_path": "a"}), is_plain(5000)
    (True, False, False, False)
    """
    waiting, counted = [(value, 0)], 0
    while waiting:
        item, depth = waiting.pop()
        counted += 1
        if counted > MOST_NODES or depth > MOST_DEPTH:  # lists in a pickle can contain each other repeatedly
            return False
        if isinstance(item, list | tuple):
            waiting += [(inner, depth + 1) for inner in item]
        elif isinstance(item, str):
            if not re.fullmatch(r"[\w+-]{0,100}", item):
                return False
        elif item is not None and not (isinstance(item, int | float) and -largest <= item <= largest):
            return False  # also excludes nan
    return True


def _lists(value: Any) -> Any:
    """Return tuples as lists, as in YAML."""
    return [_lists(item) for item in value] if isinstance(value, list | tuple) else value


def _shown(value: Any) -> str:
    """Describe a value briefly; it may be very long."""
    if isinstance(value, int) and abs(value) > 10**1000:
        return "an endless number"
    if isinstance(value, str):
        return ascii(value)[1:41]
    return str(value)[:40] if isinstance(value, int | float) else f"a {type(value).__name__}"
