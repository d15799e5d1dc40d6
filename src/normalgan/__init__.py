"""normalgan: from a line sketch to a surface normal map.

``normalgan.load()`` returns a painter: called with a drawing, it returns its normal map. What is named here
is imported when it is asked for: ``import normalgan`` itself takes no time.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from normalgan import metrics
    from normalgan.data.datamodule import MeshDataModule
    from normalgan.errors import InputError
    from normalgan.gan import NormalGAN
    from normalgan.painting.normal_map import NormalMap
    from normalgan.painting.painter import Painter
    from normalgan.saved_model import load

__version__ = version("normalgan")
__all__ = [
    "InputError",
    "MeshDataModule",
    "NormalGAN",
    "NormalMap",
    "Painter",
    "__version__",
    "load",
    "metrics",
]

_MODULES = {
    "InputError": "normalgan.errors",
    "MeshDataModule": "normalgan.data.datamodule",
    "NormalGAN": "normalgan.gan",
    "NormalMap": "normalgan.painting.normal_map",
    "Painter": "normalgan.painting.painter",
    "load": "normalgan.saved_model",
}
"""Where what is imported late comes from."""


def __getattr__(name: str) -> Any:
    if name == "metrics":
        return import_module("normalgan.metrics")
    if name in _MODULES:
        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module 'normalgan' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
