"""The checks of each kind of plug-in: one more kind is one more line here."""

from collections.abc import Callable
from typing import Any

from normalgan.data.augmentation import BatchAugmentation
from normalgan.data.sources import DataSource
from normalgan.hints import HintSampler
from normalgan.inference.outputs import Output
from normalgan.losses import AdversarialObjective, Reconstruction
from normalgan.metrics import MapMetric
from normalgan.models import Discriminator, Generator
from normalgan.rendering import Renderer
from normalgan.rendering.lines import LineDrawing
from normalgan.testing.augmentations import augmentation_checks
from normalgan.testing.conformance import Check, ConformanceError
from normalgan.testing.data_sources import data_source_checks
from normalgan.testing.hint_samplers import hint_sampler_checks
from normalgan.testing.line_drawings import line_drawing_checks
from normalgan.testing.losses import objective_checks, reconstruction_checks
from normalgan.testing.metrics import metric_checks
from normalgan.testing.networks import discriminator_checks, generator_checks
from normalgan.testing.outputs import output_checks
from normalgan.testing.renderers import renderer_checks

__all__ = ["KINDS", "check", "checks"]

KINDS: dict[type, Callable[..., list[Check[Any]]]] = {
    AdversarialObjective: objective_checks,
    BatchAugmentation: augmentation_checks,
    DataSource: data_source_checks,
    Discriminator: discriminator_checks,
    Generator: generator_checks,
    HintSampler: hint_sampler_checks,
    LineDrawing: line_drawing_checks,
    MapMetric: metric_checks,
    Output: output_checks,
    Reconstruction: reconstruction_checks,
    Renderer: renderer_checks,
}
"""What lists the checks of a kind, by the base of its classes."""

_NETWORKS = (Generator, Discriminator)


def checks(kind: type, size: int = 64) -> list[Check[Any]]:
    """Return the checks of a kind, each with a name, for ``pytest.mark.parametrize``.

    Args:
        kind: the base of its classes, such as `HintSampler`, or a class derived from it.
        size: side in pixels of the inputs of generators and discriminators.

    Raises:
        ConformanceError: if it is not a kind of plug-in.
    """
    for base, listed in KINDS.items():
        if issubclass(kind, base):
            return listed(size) if issubclass(base, _NETWORKS) else listed()
    known = ", ".join(base.__name__ for base in KINDS)
    raise ConformanceError(f"{kind.__name__} is not a kind of plug-in; it must derive from one of {known}.")


def check(plugin: object, size: int = 64) -> None:
    """Run all checks of its kind on a plug-in. The mode of a network and torch's random state may change.

    Args:
        plugin: with the settings it is to be checked with; small networks save time.
        size: side in pixels of the inputs of generators and discriminators.

    Raises:
        ConformanceError: at the first fault, in one sentence.
    """
    for each in checks(plugin if isinstance(plugin, type) else type(plugin), size):
        each(plugin)
