"""Part: a piece of a model as a file from anywhere may name it: a registered class with plain settings."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from jsonargparse import ArgumentParser

from normalgan.errors import InputError, brief
from normalgan.limits import MOST_DEPTH
from normalgan.registry import Registry

T = TypeVar("T")

LARGEST = 4096
"""No width, depth or size of a network is larger; what is, was made up to take all time or memory."""


@dataclass(frozen=True)
class Part:
    """A class and its settings.

    Args:
        name: of a class that a registry knows.
        settings: of it, by name.
    """

    name: str
    settings: Mapping[str, Any]

    @classmethod
    def of(cls, configuration: Mapping[str, Any]) -> "Part":
        """Return the part of a configuration with ``class_path`` and ``init_args``, as checkpoints have it.

        >>> Part.of({"class_path": "normalgan.hints.UniformHints", "init_args": {"minimum": 1}})
        Part(name='UniformHints', settings={'minimum': 1})
        """
        return cls(configuration["class_path"].rpartition(".")[2], dict(configuration.get("init_args") or {}))

    def to_json(self) -> str:
        """Return the part as text."""
        return json.dumps({"class_path": self.name, "init_args": dict(self.settings)})

    @classmethod
    def from_json(cls, text: str) -> "Part":
        """Return the part that a text names; nothing that it says is looked up yet.

        Raises:
            InputError: if the text says anything else.
        """
        try:
            content = json.loads(text, parse_constant=float)
            name, settings = content.pop("class_path"), content.pop("init_args")
        except (ValueError, RecursionError, AttributeError, KeyError, TypeError):
            raise InputError("what it names is no class with settings.") from None
        if content or not isinstance(name, str) or not isinstance(settings, dict):
            raise InputError("what it names is no class with settings.")
        for key, value in settings.items():
            if not _plain(value):
                raise InputError(
                    f"{key[:40]} of {name[:40]} is {str(value)[:40]}, but settings that weights bring are "
                    f"numbers up to {LARGEST}, words, true, false, null, or lists of these."
                )
        return cls(name, settings)

    def configuration(self, registry: Registry[Any]) -> dict[str, Any]:
        """Return the part as a configuration names it, by the full name of the class.

        Raises:
            InputError: if the registry, plug-ins included, knows no class of the name.
        """
        if self.name not in registry.names():
            registry.discover()
        for known in registry:
            if known.__name__ == self.name:
                path = f"{known.__module__}.{known.__qualname__}"
                return {"class_path": path, "init_args": dict(self.settings)}
        raise InputError(registry.explain_unknown(self.name[:40]))

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
        except Exception as error:  # a class of anybody's, given settings of anybody's
            raise InputError(f"{self.name} does not take its settings: {brief(error)}") from error
        return built


def _plain(value: Any, depth: int = 0) -> bool:
    """Return whether a setting can do nothing but be one: a path with dots might import what it names."""
    if isinstance(value, list):
        return depth < MOST_DEPTH and all(_plain(item, depth + 1) for item in value)
    if isinstance(value, str):
        return re.fullmatch(r"[\w+-]{0,100}", value) is not None
    return value is None or (isinstance(value, (int, float)) and -LARGEST <= value <= LARGEST)
