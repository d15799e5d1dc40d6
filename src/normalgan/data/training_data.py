"""What training samples and their order depend on: kept in checkpoints, compared when a run is resumed."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from normalgan.data.manifest import fingerprints
from normalgan.data.settings import DataSettings

_SHORT = 40  # characters of a value that are told


def describe_training_data(settings: DataSettings, processes: int) -> dict[str, Any]:
    """Return all that decides which training samples come when, by setting, as plain values for JSON.

    Args:
        settings: of the data.
        processes: that train side by side.

    Raises:
        InputError: if the meshes or the split cannot be used.
    """
    meshes = json.dumps(fingerprints({"train": settings.sources["train"]}))
    recipe = settings.recipe.describe()
    version = recipe.pop("rendering_version")
    augmentation = settings.augmentation
    described = {
        "data.meshes": hashlib.sha256(meshes.encode()).hexdigest(),
        "data.train_views": settings.views_per_mesh["train"],
        "data.on_the_fly": settings.on_the_fly,
        "data.batch_size": settings.batch_size,
        "data.augmentation": augmentation.settings if augmentation else None,
        **{f"data.{name}": value for name, value in recipe.items()},
        "the number of processes": processes,
        "the version of the rendering": version,
    }
    plain: dict[str, Any] = json.loads(json.dumps(described))
    return plain


def changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return what has changed, by setting; empty if nothing.

    >>> before = {"data.batch_size": 8, "data.meshes": "0f" * 32, "data.size": 64}
    >>> changes(before, {"data.batch_size": 4, "data.meshes": "1e" * 32, "data.size": 64})
    'data.batch_size (8, now 4), data.meshes'
    """
    return ", ".join(
        _change(name, before[name], now.get(name)) for name in before if before[name] != now.get(name)
    )


def _change(name: str, before: object, now: object) -> str:
    told = f"{json.dumps(before)}, now {json.dumps(now)}"
    return f"{name} ({told})" if len(told) <= _SHORT else name
