"""Settings that are ignored, because a model keeps those of its training."""

import importlib
import inspect
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from normalgan.files.limits import load_yaml

__all__ = ["given_names", "ignored_settings"]


def given_names(arguments: Sequence[str], configs: Sequence[str], section: str) -> set[str]:
    """Return the settings of a section that were given, even if they equal the defaults, in dots.

    Args:
        arguments: a command's arguments.
        configs: paths of the configurations among them.
        section: such as ``model``.

    >>> sorted(given_names(["--model.seed", "1", "--model.generator.init_args.width=8"], [], "model"))
    ['generator.width', 'seed']
    """
    found = {
        m[1] for argument in arguments if (m := re.match(rf"--{section}\.([\w.]+?)\+?(?:=|$)", argument))
    }
    for path in configs:
        content = load_yaml(Path(path).read_text(encoding="utf-8"))
        found |= set(_names(content.get(section) if isinstance(content, Mapping) else None))
    return {re.sub(r"\.(init_args|class_path)\b", "", name) for name in found}


def _names(settings: Any, prefix: str = "") -> Iterator[str]:
    if isinstance(settings, Mapping):
        for name, value in settings.items():
            yield f"{prefix}{name}"
            yield from _names(value, f"{prefix}{name}.")


def ignored_settings(
    settings: Mapping[str, Any],
    defaults: Mapping[str, Any],
    saved: Mapping[str, Any],
    given: Collection[str] = (),
    prefix: str = "",
) -> list[str]:
    """Return the settings that differ from those of a model's training.

    Args:
        settings: settings of the model as parsed, nested.
        defaults: its settings if none are given; those of classes are looked up in their signatures.
        saved: those that it was trained with.
        given: names in dots of the given settings, which count even if they equal the defaults.
        prefix: prefix of the names in ``given``.

    >>> ignored_settings({"n_critic": 3, "seed": 0}, {"n_critic": 5, "seed": 0}, {"n_critic": 5, "seed": 1})
    ['n_critic']
    >>> ignored_settings({"seed": 0}, {"seed": 0}, {"seed": 1}, ["seed"])
    ['seed']
    """
    names: list[str] = []
    for name, value in settings.items():
        default, before = defaults.get(name), saved.get(name)
        if _plain(value) == _plain(before):
            continue
        was_given = f"{prefix}{name}" in given
        if not isinstance(value, Mapping) or "class_path" not in value:
            names += [name] if was_given or _plain(value) != _plain(default) else []
        elif not isinstance(before, Mapping) or not _same_class(value, before):
            is_default = isinstance(default, Mapping) and _same_class(value, default)
            names += [name] if was_given or not is_default else []
        else:
            of_class = _signature(value["class_path"])
            # A setting that is newer than the model had its default in training.
            trained = {**of_class, **(before.get("init_args") or {})}
            inner = ignored_settings(
                value.get("init_args") or {}, of_class, trained, given, f"{prefix}{name}."
            )
            names += [f"{name}.{argument}" for argument in inner]
    return names


def _same_class(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    """Compare by package and name, because a package may export a class from several modules."""
    one, other = str(a.get("class_path")), str(b.get("class_path"))
    return one.rpartition(".")[2] == other.rpartition(".")[2] and (
        one.partition(".")[0] == other.partition(".")[0]
    )


def _plain(value: Any) -> Any:
    """Return tuples as the lists that YAML makes of them."""
    return list(value) if isinstance(value, tuple) else value


def _signature(class_path: str) -> dict[str, Any]:
    module, _, name = class_path.rpartition(".")
    parameters = inspect.signature(getattr(importlib.import_module(module), name)).parameters.values()
    return {p.name: p.default for p in parameters}
