"""Plug-ins: the classes that a setting can name, ours and those of the libraries under us."""

import contextlib
import inspect
from collections.abc import Iterator
from typing import Any

from lightning.pytorch import Callback
from lightning.pytorch.loggers import Logger
from torch.optim import Optimizer
from torch.optim.lr_scheduler import LRScheduler

from normalgan.data.augmentation import Augmentation
from normalgan.hints import HINT_SAMPLERS
from normalgan.models import DISCRIMINATORS, GENERATORS
from normalgan.objectives import ADVERSARIAL_OBJECTIVES, RECONSTRUCTIONS
from normalgan.registry import Registry
from normalgan.rendering.lines import LINE_DRAWINGS
from normalgan.rendering.renderers import RENDERERS

REGISTRIES: dict[str, Registry[Any]] = {
    "renderer": RENDERERS,
    "lines": LINE_DRAWINGS,
    "hint_sampler": HINT_SAMPLERS,
    "generator": GENERATORS,
    "discriminator": DISCRIMINATORS,
    "objective": ADVERSARIAL_OBJECTIVES,
    "reconstruction": RECONSTRUCTIONS,
}
"""The registry behind each setting that names a plug-in."""


def namable() -> dict[str, Registry[Any]]:
    """Return what each setting that takes a class may name, by the last part of the setting."""
    optimizers = _subclasses(Optimizer)
    return {
        **REGISTRIES,
        "styles": LINE_DRAWINGS,  # of a mixture
        "generator_optimizer": optimizers,
        "discriminator_optimizer": optimizers,
        "lr_scheduler": _subclasses(LRScheduler),
        "logger": _subclasses(Logger),
        "callbacks": _subclasses(Callback),
        "augmentation": _subclasses(Augmentation),
    }


def _subclasses(base: type[Any]) -> Registry[Any]:
    """Return the concrete classes imported so far that derive from a library's base."""
    registry: Registry[Any] = Registry(base, "")
    for cls in list(_descend(base))[1:] or [base]:
        if not cls.__name__.startswith("_") and not inspect.isabstract(cls):
            with contextlib.suppress(ValueError):  # a second class of the name: the first will do
                registry.register(cls)
    return registry


def _descend(cls: type[Any]) -> Iterator[type[Any]]:
    yield cls
    for child in cls.__subclasses__():
        yield from _descend(child)
