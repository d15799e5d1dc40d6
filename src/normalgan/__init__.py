"""normalgan: from a line sketch to a surface normal map.

``normalgan.load()`` returns a predictor: call it with a drawing to get the normal map. Each public name is
imported on first use, so ``import normalgan`` itself is fast.
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from normalgan import hints, losses, metrics, models
    from normalgan.data.datamodule import MeshDataModule
    from normalgan.data.sources import Pairs
    from normalgan.errors import InputError
    from normalgan.gan import NormalGAN
    from normalgan.inference.load import load
    from normalgan.inference.normal_map import NormalMap
    from normalgan.inference.predictor import Predictor

    __version__: str

__all__ = [
    "InputError",
    "MeshDataModule",
    "NormalGAN",
    "NormalMap",
    "Pairs",
    "Predictor",
    "__version__",
    "hints",
    "load",
    "losses",
    "metrics",
    "models",
]

# On import, ONNX Runtime 1.32 writes a device id for telemetry into the home folder unless this is set.
os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")

_MODULES = {
    "InputError": "normalgan.errors",
    "MeshDataModule": "normalgan.data.datamodule",
    "NormalGAN": "normalgan.gan",
    "NormalMap": "normalgan.inference.normal_map",
    "Predictor": "normalgan.inference.predictor",
    "Pairs": "normalgan.data.sources",
    "load": "normalgan.inference.load",
}
"""The module of each lazily imported name."""
_PACKAGES = ("hints", "metrics", "models", "losses")
"""Lazily imported packages, with all their public names."""


def __getattr__(name: str) -> Any:
    if name == "__version__":  # looking it up takes as long as the rest of ``normalgan --help``
        return import_module("normalgan.version").__version__
    try:
        if name in _PACKAGES:
            return import_module(f"normalgan.{name}")
        if name in _MODULES:
            return getattr(import_module(_MODULES[name]), name)
    except ModuleNotFoundError as error:
        sentence = import_module("normalgan.errors").without_extra(f"normalgan.{name}", error)
        raise ModuleNotFoundError(sentence or str(error), name=error.name) from error
    raise AttributeError(f"module 'normalgan' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__]
