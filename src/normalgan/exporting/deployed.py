"""Deployed: a generator with the inputs and outputs that an exported model has."""

from dataclasses import replace

import torch
from torch import Tensor, nn

from normalgan.models import Generator
from normalgan.models.base import check_generated
from normalgan.models.condition import make_condition
from normalgan.weights.checkpoint import read_model
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.shipped import find_model

__all__ = ["Deployed", "load"]


class Deployed(nn.Module):
    """Takes sketch and hints, returns normals and optional confidence; dropout off, statistics fixed.

    Args:
        generator: the network.
        size: side of the pictures in pixels.

    Raises:
        InputError: if the generator cannot predict that size.
    """

    def __init__(self, generator: Generator, size: int) -> None:
        super().__init__()
        self.generator = generator
        self.size = size
        self.eval().requires_grad_(False)
        example = self.example(1)
        predicted = self._predicted(*example)
        check_generated(generator, predicted, make_condition(*example))
        self.outputs = ["normal", "confidence"][: predicted.shape[1] - 2]

    @property
    def name(self) -> str:
        """Name of the generator's class."""
        return type(self.generator).__name__

    def example(self, count: int) -> tuple[Tensor, Tensor]:
        """Return inputs of the right shapes: a sketch (N, 1, S, S) and hints (N, 4, S, S)."""
        return torch.zeros(count, 1, self.size, self.size), torch.zeros(count, 4, self.size, self.size)

    def forward(self, sketch: Tensor, hints: Tensor) -> tuple[Tensor, ...]:
        """Return normals (N, 3, S, S) and, if the generator has one, their confidence (N, 1, S, S)."""
        predicted = self._predicted(sketch, hints)
        return (predicted[:, :3], predicted[:, 3:]) if len(self.outputs) > 1 else (predicted,)

    def _predicted(self, sketch: Tensor, hints: Tensor) -> Tensor:
        predicted: Tensor = self.generator(make_condition(sketch, hints))
        return predicted


def load(name: str, size: int | None = None, licence: str | None = None) -> tuple[Deployed, ModelMetadata]:
    """Return the generator in a file and the notes on it; nothing in the file is executed.

    Args:
        name: name of a checkpoint, safetensors or ONNX file; ``shipped`` for the one in the package.
        size: side of the pictures; None for the size of its training, if the model or its run records it.
        licence: licence of the weights; None takes the file's.

    Raises:
        InputError: if it is missing, damaged, not one of ours, or no size is known.
    """
    weights = read_model(find_model(name), size)
    notes = replace(weights.notes, size=size or weights.notes.size, licence=licence or weights.notes.licence)
    return Deployed(weights.generator(), notes.size), notes
