"""Discovery: find the classes that settings can name, in this package, its plug-ins and its libraries."""

import contextlib
import inspect
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import entry_points
from itertools import accumulate
from typing import Any

from normalgan.data.augmentation import AUGMENTATIONS
from normalgan.data.sources import DATA_SOURCES
from normalgan.errors import did_you_mean
from normalgan.hints import HINT_SAMPLERS
from normalgan.inference.outputs import OUTPUTS
from normalgan.losses import ADVERSARIAL_OBJECTIVES, RECONSTRUCTIONS
from normalgan.metrics import METRICS
from normalgan.models import DISCRIMINATORS, GENERATORS
from normalgan.registry import LeftOut, Registry, offerer, summary
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
    "source": DATA_SOURCES,
    "augmentation": AUGMENTATIONS,
    "metrics": METRICS,
    "output": OUTPUTS,
}
"""The registry of each kind of plug-in."""

_SECTIONS = {**dict.fromkeys(("renderer", "lines", "source", "augmentation"), "data"), "metrics": "report"}
SETTINGS = {kind: f"{_SECTIONS.get(kind, 'model')}.{kind}" for kind in REGISTRIES if kind != "output"}
"""The setting that names a plug-in of each kind; outputs have options of their own instead."""


def load_plugins() -> None:
    """Import and register the plug-ins of all installed packages; warn about plug-ins that fail to load."""
    for registry in REGISTRIES.values():
        registry.load_entry_points()


def namable() -> dict[str, Registry[Any]]:
    """Return the classes that each setting may name, by the last part of the setting."""
    # Imported here because Lightning takes ten seconds to import and listing plug-ins does not need it.
    from lightning.pytorch import Callback
    from lightning.pytorch.loggers import Logger
    from torch.optim import Optimizer
    from torch.optim.lr_scheduler import LRScheduler

    optimizers = _subclasses(Optimizer)
    return {
        **REGISTRIES,
        "styles": LINE_DRAWINGS,  # the styles of a mixture
        "generator_optimizer": optimizers,
        "discriminator_optimizer": optimizers,
        "lr_scheduler": _subclasses(LRScheduler),
        "logger": _subclasses(Logger),
        "callbacks": _subclasses(Callback),
    }


_OPTIMIZERS = "ASGD Adadelta Adagrad Adam AdamW Adamax NAdam RAdam RMSprop Rprop SGD"
_SCHEDULES = (
    "ConstantLR CosineAnnealingLR CosineAnnealingWarmRestarts CyclicLR ExponentialLR LinearLR MultiStepLR "
    "OneCycleLR PolynomialLR ReduceLROnPlateau StepLR"
)
_CALLBACKS = (
    "DeviceStatsMonitor EarlyStopping LearningRateMonitor ModelSummary RichModelSummary RichProgressBar "
    "TQDMProgressBar Timer"
)
_SAFE = {
    "torch.optim": _OPTIMIZERS,
    "torch.optim.lr_scheduler": _SCHEDULES,
    "lightning.pytorch.cli": "ReduceLROnPlateau",
    "lightning.pytorch.callbacks": _CALLBACKS,
    "lightning.pytorch.loggers": "CSVLogger TensorBoardLogger",
    "normalgan.callbacks": (
        "LearningCurve StableSchedule StartFrom StoppedCheckpoint WallClockSchedule WarmAverage"
    ),
    "normalgan.callbacks.checkpoints": "AtomicCheckpointIO LastCheckpoint",
    "normalgan.data.sources": "MeshGroup",
    "normalgan.rendering": "Views",
    "normalgan.rendering.hand": "Hand",
    "normalgan.rendering.media": "Medium",
    "normalgan.rendering.variation": "Variation",
    "normalgan.gan": "_rmsprop",
    "normalgan.optimizers": "MuonRAdam",
}
"""Other classes that a safe configuration may name; none of them takes a function or an output path."""


def safe_imports() -> list[str]:
    """Return every dotted import path that a configuration may name under ``--safe-config``.

    These are the registered classes and some classes of torch, Lightning and this package. Each class can be
    named by its own module and by every package above it.

    >>> "torch.optim.RAdam" in safe_imports(), "torch.optim.radam.RAdam" in safe_imports()
    (True, True)
    """
    named = [
        getattr(import_module(module), name) for module, names in _SAFE.items() for name in names.split()
    ]
    plugins = [cls for registry in REGISTRIES.values() for cls in registry]
    return sorted(
        f"{package}.{found.__qualname__}"
        for found in {*named, *plugins}
        if found.__qualname__.isidentifier()  # local classes cannot be named in a setting
        for package in accumulate(found.__module__.split("."), "{}.{}".format)
    )


def misplaced() -> list[LeftOut]:
    """Return entry points in unknown groups named ``normalgan.*``, which are probably typos."""
    groups = [registry.group for registry in REGISTRIES.values()]
    strange = [g for g in entry_points().groups if g.startswith("normalgan.") and g not in groups]
    return [
        LeftOut(
            entry.name,
            entry.value,
            entry.group,
            offerer(entry),
            f"there is no group {entry.group}.{did_you_mean(entry.group, groups)}".rstrip("."),
        )
        for group in sorted(strange)
        for entry in entry_points(group=group)
    ]


def described(section: str = "") -> str:
    """Return a list of all plug-ins with their summaries, by setting, for the end of a command's help.

    Args:
        section: ``model`` or ``data`` restricts the list to settings of that section; empty lists all.
    """
    parts = []
    for kind, setting in SETTINGS.items():
        if not setting.startswith(section):
            continue
        registry = REGISTRIES[kind]
        parts.append(f"\n  --{setting}")
        width = max(map(len, registry.names()))
        parts += [f"    {cls.__name__:{width}}  {summary(cls)}".rstrip() for cls in registry]
    opening = "plug-ins by setting; normalgan plugins lists the package of each:"
    return "\n".join([opening, *parts]) + "\n" if parts else ""


def _subclasses(base: type[Any]) -> Registry[Any]:
    """Return the concrete subclasses of a library's base class that have been imported so far."""
    registry: Registry[Any] = Registry(base, "")
    for cls in list(_descend(base))[1:] or [base]:
        if not cls.__name__.startswith("_") and not inspect.isabstract(cls):
            with contextlib.suppress(ValueError):  # of classes with the same name, the first is listed
                registry.register(cls)
    return registry


def _descend(cls: type[Any]) -> Iterator[type[Any]]:
    yield cls
    for child in cls.__subclasses__():
        yield from _descend(child)
