"""The former name of `normalgan.painting`: its documented modules by their old paths, for one release."""

import sys
import warnings
from importlib import import_module
from types import ModuleType

__all__ = []

warnings.warn(
    "normalgan.inference is now normalgan.painting; the old name goes with the next release.",
    DeprecationWarning,
    stacklevel=2,
)
for _old, _new, _renamed in (
    ("session", "onnx_backend", {"Model": "OnnxBackend"}),
    ("preparation", "preparation", {}),
    ("painting", "pipeline", {"Painted": "NormalMap"}),
    ("height", "height", {}),
    ("relief", "relief", {}),
    ("preview", "preview", {}),
):
    # The same objects by both paths: a class is the same class.
    _here = sys.modules[f"{__name__}.{_old}"] = ModuleType(f"{__name__}.{_old}")
    _there = vars(import_module(f"normalgan.painting.{_new}"))
    vars(_here).update({name: value for name, value in _there.items() if not name.startswith("__")})
    vars(_here).update({was: _there[name] for was, name in _renamed.items()})
    globals()[_old] = _here
