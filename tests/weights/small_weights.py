"""Weights of small generators."""

import torch

from normalgan.models import UNetGenerator
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import Weights
from normalgan.weights.metadata import ModelMetadata

torch.set_num_threads(1)

SETTINGS = {"size": 32, "width": 4, "norm": "batch", "depth": None, "bias": False, "dropout": 0.5}


def make_generator() -> UNetGenerator:
    """A generator whose weights and statistics are not those of a new one."""
    torch.manual_seed(0)
    generator = UNetGenerator(size=32, width=4)
    for buffer in generator.buffers():
        if buffer.is_floating_point():
            buffer.copy_(torch.rand_like(buffer) + 0.5)
    return generator.eval()


def make_weights(generator: UNetGenerator | None = None) -> Weights:
    """The weights of a generator, and notes on it."""
    notes = ModelMetadata(
        generator=ClassSpec("UNetGenerator", SETTINGS),
        hint_sampler=ClassSpec("UniformHints", {"minimum": 2, "maximum": 9, "none": 0.25}),
        size=32,
        noise_at_test=True,
        seed=7,
        licence="CC0-1.0",
    )
    return Weights(notes, (generator or make_generator()).state_dict())
