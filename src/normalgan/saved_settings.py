"""SavedSettings: a LightningModule that saves its classes and settings as text in checkpoints."""

from collections.abc import Mapping
from functools import partial
from inspect import signature
from typing import Any

from lightning.pytorch import LightningModule
from lightning.pytorch.utilities.parsing import AttributeDict

from normalgan.registry import class_path
from normalgan.weights.checkpoint import (
    DEFAULT_OPTIMIZER,
    MADE_IN_PYTHON,
    OF_TORCH,
    PICTURE_SIZE,
    REGISTRIES,
    uncompiled,
)
from normalgan.weights.class_spec import ANY_NUMBER, ClassSpec, is_plain

_OF_TRAINING = {"compile"}
"""Arguments of the model that depend on the training machine and are not saved."""


class SavedSettings(LightningModule):
    """Saves a module's arguments as text, and its weights under the names of the uncompiled networks."""

    _picture_size: int | None = None

    @property
    def hparams_initial(self) -> AttributeDict:
        """The hyperparameters for loggers: classes and settings, as values that any YAML reader accepts.

        Given the objects themselves, loggers would write each weight as text: 8 MB per million weights.
        """
        settings = _settings_to_save(self._given())
        return AttributeDict({k: list(v) if isinstance(v, tuple) else v for k, v in settings.items()})

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Store classes and settings as text, so that loading a checkpoint does not execute code from it."""
        checkpoint[self.CHECKPOINT_HYPER_PARAMS_KEY] = _settings_to_save(self._given())
        checkpoint["state_dict"] = {uncompiled(k): v for k, v in checkpoint["state_dict"].items()}
        if self._picture_size is not None:
            checkpoint[PICTURE_SIZE] = self._picture_size

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Rename the weights for this module, which may hold networks wrapped by ``torch.compile``."""
        own = {uncompiled(name): name for name in self.state_dict()}
        weights = checkpoint["state_dict"]
        checkpoint["state_dict"] = {own.get(uncompiled(k), k): v for k, v in weights.items()}

    def _given(self) -> dict[str, Any]:
        """Return all arguments of the module, including unpicklable ones that Lightning drops.

        Without these, a run with an optimiser from a lambda would resume with the default optimiser.
        """
        dropped = signature(type(self)).parameters.keys() - self.hparams.keys()
        return {**{name: getattr(self, name) for name in dropped if hasattr(self, name)}, **self.hparams}


def _settings_to_save(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a model as stored in a checkpoint: class names and plain values, not objects.

    Objects that plain values cannot describe are stored by class name only; resume such a model from
    Python.

    Args:
        given: hyperparameters from Lightning: configurations if the command line built the model,
            otherwise objects.
    """
    saved: dict[str, Any] = {"_instantiator": "lightning.pytorch.cli.instantiate_module"}
    for name, value in given.items():
        if name in _OF_TRAINING:
            continue
        if name in OF_TORCH:
            saved[name] = _optimizer_to_save(value)
        elif name in REGISTRIES and value is not None and not isinstance(value, Mapping):
            part = ClassSpec.of_object(value)
            saved[name] = _made_in_python(value) if part is None else part.to_dict()
        else:
            saved[name] = value
    return saved


def _optimizer_to_save(value: Any) -> Any:
    if value is None or isinstance(value, str | Mapping):
        return value
    if getattr(value, "__module__", None) == "normalgan.gan" and value.__qualname__ == "_rmsprop":
        return DEFAULT_OPTIMIZER
    kind, settings = (value.func, value.keywords) if isinstance(value, partial) else (value, {})
    plain = not getattr(value, "args", ()) and all(is_plain(each, ANY_NUMBER) for each in settings.values())
    if plain and isinstance(kind, type):
        return ClassSpec(class_path(kind), dict(settings)).to_dict()
    return _made_in_python(kind)


def _made_in_python(value: object) -> dict[str, str]:
    kind = value if hasattr(value, "__qualname__") else type(value)
    return {MADE_IN_PYTHON: f"{kind.__module__}.{kind.__qualname__}"}
