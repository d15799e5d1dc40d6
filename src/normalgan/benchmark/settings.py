"""Settings: nest, flatten, compare and merge the settings of `normalgan fit`."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from normalgan.benchmark.plan import Settings
from normalgan.errors import InputError

MACHINE = (
    *("data.cache", "data.meshes", "data.storage", "data.workers"),
    *("trainer.default_root_dir", "trainer.enable_progress_bar"),
    *("ckpt_path", "output", "pictures", "report", "trainer.logger", "weights_only"),
)
"""Settings of paths and resources, which do not change any figure."""


def nest(dotted: Mapping[str, Any]) -> Settings:
    """Return dotted settings as nested mappings.

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
                raise InputError(f"the setting {name} lies in a setting that already has a value.")
        if last in place:
            raise InputError(f"the setting {name} is given twice.")
        place[last] = nest(value) if isinstance(value, Mapping) else value
    return nested


def flatten(settings: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested settings by their dotted names.

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
    """Return only the named settings and groups; None returns all.

    >>> part({"data": {"size": 64, "workers": 2}, "trainer": {"devices": 1}}, ["data.size", "trainer"])
    {'data': {'size': 64}, 'trainer': {'devices': 1}}
    """
    if names is None:
        return dict(settings)
    return nest({name: value for name, value in flatten(settings).items() if _under(name, names)})


def without(settings: Mapping[str, Any], names: Sequence[str]) -> Settings:
    """Return the settings without the named settings and groups."""
    return nest({name: value for name, value in flatten(settings).items() if not _under(name, names)})


def compose(layers: Sequence[Mapping[str, Any]]) -> Settings:
    """Return all settings of `normalgan fit` with defaults; later layers win.

    Raises:
        InputError: if `normalgan fit` would refuse the settings.
    """
    from normalgan.cli.training.command import resolved_settings  # here because it imports lightning

    with TemporaryDirectory() as folder:
        arguments: list[str] = []
        for i, layer in enumerate(filter(None, layers)):
            path = Path(folder) / f"{i}.yaml"
            path.write_text(yaml.safe_dump(dict(layer)), encoding="utf-8")
            arguments += ["--config", str(path)]
        return resolved_settings(arguments)


def digest(settings: Mapping[str, Any]) -> str:
    """Return a hash of the settings, 12 characters long and independent of their order.

    >>> digest({"a": 1, "b": [2]}) == digest({"b": [2], "a": 1}) != digest({"a": 1, "b": [3]})
    True
    """
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:12]


def differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[str]:
    """Return the dotted names of the settings that differ.

    >>> differences({"data": {"size": 64, "seed": 0}}, {"data": {"size": 32, "seed": 0}})
    ['data.size']
    """
    left, right = flatten(a), flatten(b)
    missing = object()
    return sorted(n for n in left.keys() | right.keys() if left.get(n, missing) != right.get(n, missing))


def _under(name: str, names: Sequence[str]) -> bool:
    return any(name == known or name.startswith(f"{known}.") for known in names)
