"""The former name of `normalgan.painting`: its documented modules by their old paths, for one release."""

import sys
import warnings
from importlib import import_module

warnings.warn(
    "normalgan.inference is now normalgan.painting; the old name goes with the next release.",
    DeprecationWarning,
    stacklevel=2,
)
for _name in ("session", "preparation", "painting", "height", "relief", "preview"):
    # An alias, no second copy: a class is the same class by both paths.
    globals()[_name] = sys.modules[f"{__name__}.{_name}"] = import_module(f"normalgan.painting.{_name}")
