"""The checks for each kind of plug-in."""

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
"""Functions that return the checks, by the base class of the plug-ins."""

_NETWORKS = (Generator, Discriminator)


def checks(kind: type, size: int = 64) -> list[Check[Any]]:
    """Return the named checks for one kind of plug-in, for ``pytest.mark.parametrize``.

    Args:
        kind: base class of the plug-ins, such as `HintSampler`, or a class derived from it.
        size: side of the inputs of generators and discriminators, in pixels.

    Raises:
        ConformanceError: if ``kind`` is not such a class.
    """
    for base, listed in KINDS.items():
        if issubclass(kind, base):
            return listed(size) if issubclass(base, _NETWORKS) else listed()
    known = ", ".join(base.__name__ for base in KINDS)
    raise ConformanceError(f"{kind.__name__} is not a kind of plug-in; it must derive from one of {known}.")


def check(plugin: object, size: int = 64) -> None:
    """Run all checks on a plug-in. The mode of a network and torch's random state may change.

    Args:
        plugin: plug-in with the settings to check; small networks save time.
        size: side of the inputs of generators and discriminators, in pixels.

    Raises:
        ConformanceError: for the first failed check, in one sentence.
    """
    for each in checks(plugin if isinstance(plugin, type) else type(plugin), size):
        each(plugin)
