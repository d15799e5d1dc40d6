"""A description of the training data, kept in checkpoints and compared when a run is resumed."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["changes", "describe_training_data"]

_SHORT = 40  # the most characters of a value that are shown


def describe_training_data(
    fingerprints: Sequence[tuple[str, str]],
    recipe: Mapping[str, Any],
    augmentation: object,
    settings: Mapping[str, Any],
    processes: int,
) -> dict[str, Any]:
    """Return everything that decides the training samples and their order, by setting, as JSON values.

    Args:
        fingerprints: name and fingerprint of every mesh or pair.
        recipe: how samples are made of them, as it describes itself.
        augmentation: its settings, None for none.
        settings: other settings that count, by name.
        processes: that train side by side.
    """
    of_recipe = dict(recipe)
    version = of_recipe.pop("rendering_version")
    described = {
        "data.meshes": hashlib.sha256(json.dumps({"train": fingerprints}).encode()).hexdigest(),
        **settings,
        "data.augmentation": augmentation,
        **{f"data.{name}": value for name, value in of_recipe.items()},
        "the number of processes": processes,
        "the version of the rendering": version,
    }
    plain: dict[str, Any] = json.loads(json.dumps(described))
    return plain


def changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the settings that have changed; empty if nothing.

    >>> before = {"data.batch_size": 8, "data.meshes": "0f" * 32, "data.size": 64}
    >>> changes(before, {"data.batch_size": 4, "data.meshes": "1e" * 32, "data.size": 64})
    'data.batch_size (8, now 4), data.meshes'
    """
    return ", ".join(
        _change(name, before[name], now.get(name)) for name in before if before[name] != now.get(name)
    )


def _change(name: str, before: object, now: object) -> str:
    shown = f"{json.dumps(before)}, now {json.dumps(now)}"
    return f"{name} ({shown})" if len(shown) <= _SHORT else name
