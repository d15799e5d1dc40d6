"""Deployed: a generator with the inputs and outputs of an exported model."""

from dataclasses import replace

import torch
from torch import Tensor, nn

from normalgan.models import Generator
from normalgan.models.base import check_generated
from normalgan.models.condition import make_condition
from normalgan.weights.checkpoint import read_model
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.shipped import find_model


class Deployed(nn.Module):
    """Maps sketch and hints to normals and optional confidence, in evaluation mode.

    Args:
        generator: generator to wrap.
        size: side of the pictures in pixels.

    Raises:
        InputError: if the generator cannot predict at that size.
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
        """Return example inputs: a sketch (N, 1, S, S) and hints (N, 4, S, S)."""
        return torch.zeros(count, 1, self.size, self.size), torch.zeros(count, 4, self.size, self.size)

    def forward(self, sketch: Tensor, hints: Tensor) -> tuple[Tensor, ...]:
        """Return normals (N, 3, S, S) and, if the generator predicts it, their confidence (N, 1, S, S)."""
        predicted = self._predicted(sketch, hints)
        return (predicted[:, :3], predicted[:, 3:]) if len(self.outputs) > 1 else (predicted,)

    def _predicted(self, sketch: Tensor, hints: Tensor) -> Tensor:
        predicted: Tensor = self.generator(make_condition(sketch, hints))
        return predicted


def load(name: str, size: int | None = None, licence: str | None = None) -> tuple[Deployed, ModelMetadata]:
    """Return the generator in a file and its metadata, without executing anything from the file.

    Args:
        name: path of a checkpoint, safetensors or ONNX file, or ``shipped`` for the shipped model.
        size: side of the pictures; None for the training size, if the model or its run records it.
        licence: licence of the weights; None keeps the one in the file.

    Raises:
        InputError: if the file is missing, damaged or of another kind, or if the size is unknown.
    """
    weights = read_model(find_model(name), size)
    notes = replace(weights.notes, size=size or weights.notes.size, licence=licence or weights.notes.licence)
    return Deployed(weights.generator(), notes.size), notes
