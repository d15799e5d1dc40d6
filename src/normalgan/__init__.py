"""normalgan: from a line sketch to a surface normal map.

``normalgan.load()`` returns a painter: called with a drawing, it returns its normal map. What is named here
is imported when it is asked for: ``import normalgan`` itself takes no time.
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from normalgan.old_names import OldNames

if TYPE_CHECKING:
    from normalgan import hints, metrics, models, objectives
    from normalgan.data.datamodule import MeshDataModule
    from normalgan.data.sources import Pairs
    from normalgan.errors import InputError
    from normalgan.gan import NormalGAN
    from normalgan.painting.normal_map import NormalMap
    from normalgan.painting.painter import Painter
    from normalgan.saved_model import load

    __version__: str

__all__ = [
    "InputError",
    "MeshDataModule",
    "NormalGAN",
    "NormalMap",
    "Painter",
    "Pairs",
    "__version__",
    "hints",
    "load",
    "metrics",
    "models",
    "objectives",
]

_MODULES = {
    "InputError": "normalgan.errors",
    "MeshDataModule": "normalgan.data.datamodule",
    "NormalGAN": "normalgan.gan",
    "NormalMap": "normalgan.painting.normal_map",
    "Painter": "normalgan.painting.painter",
    "Pairs": "normalgan.data.sources",
    "load": "normalgan.saved_model",
}
"""Where what is imported late comes from."""
_PACKAGES = ("hints", "metrics", "models", "objectives")
"""Packages that are imported late, each with what it offers."""


sys.meta_path.append(OldNames())


def __getattr__(name: str) -> Any:
    if name == "__version__":  # looking it up takes as long as all else that ``normalgan --help`` does
        from importlib.metadata import version

        return version("normalgan")
    if name in _PACKAGES:
        return import_module(f"normalgan.{name}")
    if name in _MODULES:
        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module 'normalgan' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__]
