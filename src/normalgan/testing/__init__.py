"""Conformance checks for authors of plug-ins; each failure is one sentence.

``check_hint_sampler(sampler)`` runs all checks; ``hint_sampler_checks()`` returns them as a list for
``pytest.mark.parametrize``. Each kind has such a pair.
"""

from normalgan.testing.augmentations import augmentation_checks, check_augmentation
from normalgan.testing.conformance import Check, ConformanceError
from normalgan.testing.data_sources import check_data_source, data_source_checks
from normalgan.testing.discriminators import check_discriminator, discriminator_checks
from normalgan.testing.generators import check_generator, generator_checks
from normalgan.testing.hint_samplers import check_hint_sampler, hint_sampler_checks
from normalgan.testing.line_drawings import check_line_drawing, line_drawing_checks
from normalgan.testing.metrics import check_metric, metric_checks
from normalgan.testing.objectives import check_objective, objective_checks
from normalgan.testing.outputs import check_output, output_checks
from normalgan.testing.reconstructions import check_reconstruction, reconstruction_checks
from normalgan.testing.renderers import check_renderer, renderer_checks

__all__ = [
    "Check",
    "ConformanceError",
    "augmentation_checks",
    "check_augmentation",
    "check_data_source",
    "check_discriminator",
    "check_generator",
    "check_hint_sampler",
    "check_line_drawing",
    "check_metric",
    "check_objective",
    "check_output",
    "check_reconstruction",
    "check_renderer",
    "data_source_checks",
    "discriminator_checks",
    "generator_checks",
    "hint_sampler_checks",
    "line_drawing_checks",
    "metric_checks",
    "objective_checks",
    "output_checks",
    "reconstruction_checks",
    "renderer_checks",
]
