"""For authors of plug-ins: checks that tell in a sentence what a class does otherwise than its kind must.

``check_hint_sampler(sampler)`` asks everything of it; ``hint_sampler_checks()`` are the same as a list of
named checks for ``pytest.mark.parametrize``. So for each kind.
"""

from normalgan.testing.conformance import Check, ConformanceError
from normalgan.testing.discriminators import check_discriminator, discriminator_checks
from normalgan.testing.generators import check_generator, generator_checks
from normalgan.testing.hint_samplers import check_hint_sampler, hint_sampler_checks
from normalgan.testing.line_drawings import check_line_drawing, line_drawing_checks
from normalgan.testing.objectives import check_objective, objective_checks
from normalgan.testing.reconstructions import check_reconstruction, reconstruction_checks
from normalgan.testing.renderers import check_renderer, renderer_checks

__all__ = [
    "Check",
    "ConformanceError",
    "check_discriminator",
    "check_generator",
    "check_hint_sampler",
    "check_line_drawing",
    "check_objective",
    "check_reconstruction",
    "check_renderer",
    "discriminator_checks",
    "generator_checks",
    "hint_sampler_checks",
    "line_drawing_checks",
    "objective_checks",
    "reconstruction_checks",
    "renderer_checks",
]
