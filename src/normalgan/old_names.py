"""Old names: import paths of the release before, which lead where things lie now, for one release."""

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["MOVED", "RENAMED", "OldNames"]

MOVED = {
    "normalgan.drawings": "normalgan.painting.reading.drawings",
    "normalgan.inference.height": "normalgan.painting.heights.height",
    "normalgan.inference.painting": "normalgan.painting.pipeline",
    "normalgan.inference.preparation": "normalgan.painting.preparation",
    "normalgan.inference.preview": "normalgan.painting.outputs.preview",
    "normalgan.inference.relief": "normalgan.painting.heights.relief",
    "normalgan.inference.session": "normalgan.painting.network.onnx_backend",
    "normalgan.painting.backend": "normalgan.painting.network.backend",
    "normalgan.painting.height": "normalgan.painting.heights.height",
    "normalgan.painting.onnx_backend": "normalgan.painting.network.onnx_backend",
    "normalgan.painting.preview": "normalgan.painting.outputs.preview",
    "normalgan.painting.relief": "normalgan.painting.heights.relief",
    "normalgan.painting.torch_backend": "normalgan.painting.network.torch_backend",
    "normalgan.painting.upsampling": "normalgan.painting.network.upsampling",
    "normalgan.rendering.animals": "normalgan.animals",
}
"""Documented modules of the release before, and where they lie now."""
RENAMED = {
    "normalgan.inference.painting": {"Painted": "NormalMap"},
    "normalgan.inference.session": {"Model": "OnnxBackend"},
}
"""What they called otherwise."""
_FOLDERS = {"normalgan.inference"}
"""Packages of the release before that held such modules, and are no more."""


class OldNames:
    """Finds and loads modules by their old names.

    `import normalgan` puts it behind Python's own finders: it is asked only for what they do not find.
    """

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """Return how to import a module, if it is one that moved."""
        if name in _FOLDERS:
            return ModuleSpec(name, self, is_package=True)  # type: ignore[arg-type]
        return ModuleSpec(name, self) if name in MOVED else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        """Leave it to Python to make the module."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the module that is meant in the place of the one asked for: its classes are the same."""
        old = module.__name__
        if old in _FOLDERS:
            return
        new = MOVED[old]
        warnings.warn(
            f"{old} is now {new}; the old name goes with the next release.", DeprecationWarning, stacklevel=2
        )
        meant = import_module(new)
        if old in RENAMED:
            vars(module).update({name: value for name, value in vars(meant).items() if name[:2] != "__"})
            vars(module).update({was: getattr(meant, name) for was, name in RENAMED[old].items()})
        else:
            sys.modules[old] = meant
