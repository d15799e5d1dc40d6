"""The former place of `normalgan.animals`, for one release."""

import sys
import warnings
from importlib import import_module

__all__ = []

warnings.warn(
    "normalgan.rendering.animals is now normalgan.animals; the old name goes with the next release.",
    DeprecationWarning,
    stacklevel=2,
)
sys.modules[__name__] = import_module("normalgan.animals")  # by name: rendering does not know the animals
