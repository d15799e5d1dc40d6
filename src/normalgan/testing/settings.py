"""Checks that the command line, checkpoints and worker processes can use a plug-in."""

import inspect
import io
import pickle
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any, TypeVar

import torch
from docstring_parser import DocstringStyle, parse
from jsonargparse import ArgumentParser
from torch import nn

from normalgan.registry import class_path, summary
from normalgan.testing.conformance import Check, demand

T = TypeVar("T")


def settings_checks(base: type[T]) -> list[Check[T]]:
    """Return the checks of the settings of a plug-in.

    Args:
        base: abstract base class of the plug-in.
    """

    def command_line(plugin: T) -> None:
        _read_from_the_command_line(plugin, base)

    # Networks need not be pickled, because checkpoints hold their state_dict. Parametrised networks, such
    # as those with torch's spectral norm, cannot be pickled.
    pickled: Check[T] = Check(
        "pickling for another process", _pickled, "it must survive pickling, so open resources lazily"
    )
    return [
        Check("an importable class", _importable, "a class must be defined at the top of a module"),
        Check("a documented class", _documented, "its docstring must be readable, in Google style"),
        Check("settings on the command line", command_line, "settings must be plain values with types"),
        Check(
            "settings in a checkpoint",
            _in_a_checkpoint,
            "settings must be numbers, strings, lists and the like",
        ),
        *([] if issubclass(base, nn.Module) else [pickled]),
    ]


def frozen_check() -> Check[Any]:
    """Return the check for plug-ins with settings that are part of the cache key of samples."""
    return Check("a frozen dataclass", _frozen, "it must be a dataclass with frozen=True")


def _frozen(plugin: object) -> None:
    params = getattr(type(plugin), "__dataclass_params__", None)
    demand(
        params is not None and params.frozen,
        plugin,
        "is not a frozen dataclass",
        "its fields are its settings, which are part of the cache key of samples",
    )


def _importable(plugin: object) -> None:
    cls = type(plugin)
    found = getattr(import_module(cls.__module__), cls.__qualname__, None)
    demand(
        found is cls,
        plugin,
        f"cannot be imported as {class_path(cls)}",
        "YAML and checkpoints name a class by its module, so define it at the top of one",
    )
    demand(
        not any(part.startswith("_") and part != "__main__" for part in class_path(cls).split(".")),
        plugin,
        f"has a part that begins with an underscore in its path {class_path(cls)}",
        "jsonargparse gives such classes no short name",
    )


def _documented(plugin: object) -> None:
    cls = type(plugin)
    demand(
        summary(cls),
        plugin,
        "has no docstring of its own",
        "--help and normalgan plugins show its first line",
    )
    texts = [
        vars(base).get("__doc__") or "" for base in cls.__mro__
    ]  # --help also reads the docstrings of base classes
    explained = {
        each.arg_name
        for text in texts
        for each in parse(inspect.cleandoc(text), style=DocstringStyle.GOOGLE).params
    }
    unexplained = [name for name in _settings_of(cls) if name not in explained]
    demand(
        not unexplained,
        plugin,
        f"does not explain {', '.join(unexplained)} in its docstring",
        "the docstring of the class needs a line under Args for each setting that no base class explains",
    )


def _read_from_the_command_line(plugin: T, base: type[T]) -> None:
    cls = type(plugin)
    for name, parameter in _settings_of(cls).items():
        demand(
            parameter.annotation is not inspect.Parameter.empty,
            plugin,
            f"has a setting {name} without a type",
            "the command line reads the type of each setting from the signature",
        )
    needed = [n for n, p in _settings_of(cls).items() if p.default is inspect.Parameter.empty]
    if not is_dataclass(plugin) and needed:
        return  # the constructor arguments are unknown
    parser = ArgumentParser(exit_on_error=False)
    parser.add_argument("--plugin", type=base)
    given = {"plugin": _as_config(plugin)}
    read = parser.parse_object(given)
    again = parser.parse_string(parser.dump(read))
    demand(
        again == read,
        plugin,
        "has other settings after a round trip through YAML",
        "settings must be numbers, strings, booleans, lists, tuples or null",
    )
    if not is_dataclass(plugin):
        return  # a network with default settings may be large, and there are no settings to compare
    built = parser.instantiate(again).plugin
    demand(
        type(built) is cls and built == plugin,
        plugin,
        "is not equal after being rebuilt from its own settings",
        "its fields must be its settings, unchanged",
    )


def _in_a_checkpoint(plugin: object) -> None:
    buffer = io.BytesIO()
    torch.save(_as_config(plugin), buffer)
    buffer.seek(0)
    try:
        loaded = torch.load(buffer, weights_only=True)
    except pickle.UnpicklingError:
        loaded = None
    demand(
        loaded == _as_config(plugin),
        plugin,
        "has settings that a checkpoint loaded with weights_only=True does not restore",
        "settings must be numbers, strings, booleans, lists, tuples or null",
    )


def _pickled(plugin: object) -> None:
    again = pickle.loads(pickle.dumps(plugin))  # pickled by ourselves just now
    demand(
        not is_dataclass(plugin) or again == plugin,
        plugin,
        "is not equal after pickling",
        "worker processes must get the same settings",
    )


def _settings_of(cls: type[Any]) -> dict[str, inspect.Parameter]:
    """Return the parameters of a class's constructor by name, except ``**kwargs``."""
    passed_on = {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD}
    return {
        name: each for name, each in inspect.signature(cls).parameters.items() if each.kind not in passed_on
    }


def _as_config(plugin: object) -> dict[str, Any]:
    """Return the configuration that rebuilds a plug-in: class_path, and init_args if known."""
    if not is_dataclass(plugin):
        return {"class_path": class_path(type(plugin))}
    values = {field.name: _plain(getattr(plugin, field.name)) for field in fields(plugin) if field.init}
    return {"class_path": class_path(type(plugin)), "init_args": values}


def _plain(value: Any) -> Any:
    """Return a setting as plain values for YAML, with nested plug-ins as configurations."""
    if is_dataclass(value):
        return _as_config(value)
    return [_plain(item) for item in value] if isinstance(value, list) else value
