"""Settings: nested mappings as `normalgan fit` takes them, merged by its parser."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from normalgan.benchmark.plan import Settings
from normalgan.errors import InputError

__all__ = ["MACHINE", "compose", "differences", "digest", "flatten", "nest", "part", "without"]

MACHINE = (
    *("data.cache", "data.meshes", "data.storage", "data.workers"),
    *("trainer.default_root_dir", "trainer.enable_progress_bar"),
    *("ckpt_path", "output", "pictures", "report", "trainer.logger", "weights_only"),
)
"""Settings that say where and how to work, and change no figure."""


def nest(dotted: Mapping[str, Any]) -> Settings:
    """Return settings in dots as nested mappings.

    Raises:
        InputError: if a setting is both a value and a group.

    >>> nest({"data.size": 64, "data.views": {"roll": 0}, "seed_everything": 1})
    {'data': {'size': 64, 'views': {'roll': 0}}, 'seed_everything': 1}
    """
    nested: Settings = {}
    for name, value in dotted.items():
        *groups, last = name.split(".")
        place = nested
        for group in groups:
            place = place.setdefault(group, {})
            if not isinstance(place, dict):
                raise InputError(f"the setting {name} lies in one that has a value already.")
        if last in place:
            raise InputError(f"the setting {name} is given twice.")
        place[last] = nest(value) if isinstance(value, Mapping) else value
    return nested


def flatten(settings: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested settings with their names in dots.

    >>> flatten({"data": {"size": 64, "hand": {}}})
    {'data.size': 64, 'data.hand': {}}
    """
    flat: dict[str, Any] = {}
    for name, value in settings.items():
        if isinstance(value, Mapping) and value:
            flat |= flatten(value, f"{prefix}{name}.")
        else:
            flat[prefix + name] = value
    return flat


def part(settings: Mapping[str, Any], names: Sequence[str] | None) -> Settings:
    """Return only those settings that are named or lie under a name; None names all.

    >>> part({"data": {"size": 64, "workers": 2}, "trainer": {"devices": 1}}, ["data.size", "trainer"])
    {'data': {'size': 64}, 'trainer': {'devices': 1}}
    """
    if names is None:
        return dict(settings)
    return nest({name: value for name, value in flatten(settings).items() if _under(name, names)})


def without(settings: Mapping[str, Any], names: Sequence[str]) -> Settings:
    """Return the settings without those that are named or lie under a name."""
    return nest({name: value for name, value in flatten(settings).items() if not _under(name, names)})


def compose(layers: Sequence[Mapping[str, Any]]) -> Settings:
    """Return all settings of `normalgan fit` with defaults; later layers win.

    Raises:
        InputError: if `normalgan fit` would refuse them.
    """
    from normalgan.cli.training.command import resolved_settings  # here: it imports lightning

    with TemporaryDirectory() as folder:
        arguments: list[str] = []
        for i, layer in enumerate(filter(None, layers)):
            path = Path(folder) / f"{i}.yaml"
            path.write_text(yaml.safe_dump(dict(layer)), encoding="utf-8")
            arguments += ["--config", str(path)]
        return resolved_settings(arguments)


def digest(settings: Mapping[str, Any]) -> str:
    """Return a hash of the settings, 12 letters and digits; their order does not matter.

    >>> digest({"a": 1, "b": [2]}) == digest({"b": [2], "a": 1}) != digest({"a": 1, "b": [3]})
    True
    """
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:12]


def differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[str]:
    """Return the names, in dots, of the settings that differ.

    >>> differences({"data": {"size": 64, "seed": 0}}, {"data": {"size": 32, "seed": 0}})
    ['data.size']
    """
    left, right = flatten(a), flatten(b)
    missing = object()
    return sorted(n for n in left.keys() | right.keys() if left.get(n, missing) != right.get(n, missing))


def _under(name: str, names: Sequence[str]) -> bool:
    return any(name == known or name.startswith(f"{known}.") for known in names)
