"""Saved models: a checkpoint, safetensors, ONNX, or the weights that come with the package, as a method."""

from pathlib import Path

import torch
from torch import Tensor

from normalgan.arrays import Floats
from normalgan.batch import Batch
from normalgan.benchmark.methods import Method, weights_method
from normalgan.callbacks.checkpoints import check_size
from normalgan.errors import InputError
from normalgan.hints import HINT_SAMPLERS
from normalgan.inference.network.onnx_backend import OnnxBackend, find_model
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.class_spec import ClassSpec
from normalgan.weights.file import SUFFIXES, find_weights, read_weights
from normalgan.weights.shipped import SHIPPED_NAME

__all__ = ["saved_method"]


def saved_method(name: str, size: int, device: torch.device) -> Method:
    """Return a model as a method; all file formats of one model give the same figures.

    Args:
        name: of the file; ``shipped`` is the one that comes with the package.
        size: side of the pictures that it is to predict.
        device: where to; ONNX predicts on the processor.

    Raises:
        InputError: if it cannot be used, or was trained at another size.
    """
    path = find_weights(name)
    if path.suffix.lower() == ".onnx" and name != SHIPPED_NAME:  # that of the package may use a GPU by torch
        return _onnx_method(find_model(name), size)
    if path.suffix.lower() in SUFFIXES:
        weights = read_weights(path)
        check_size(path, weights.notes.size, size)
        return weights_method(weights, device)
    checkpoint = read_checkpoint(path)
    check_size(path, checkpoint.generator_size(), size)
    return weights_method(checkpoint.weights(size), device)


def _onnx_method(path: Path, size: int) -> Method:
    model = OnnxBackend(path, torch.get_num_threads())
    check_size(path, model.size, size)
    if "hint_sampler" not in model.notes:
        raise InputError(f"{path} does not say what hints it was trained for; export it anew.")
    sampler = ClassSpec.from_json(model.notes["hint_sampler"]).build(HINT_SAMPLERS)

    def predict(batch: Batch, hints: Tensor | None) -> Tensor:
        given = [None] * len(batch["sketch"]) if hints is None else list(hints.cpu().numpy())
        sketches = batch["sketch"][:, 0].cpu().numpy()
        predicted = [_channels(*model.predict(*one)) for one in zip(sketches, given, strict=True)]
        return torch.stack(predicted).to(batch["sketch"])

    return Method(predict, sampler)


def _channels(normal: Floats, confidence: Floats | None) -> Tensor:
    """Return normals (S, S, 3) and confidence (S, S), if there is one, as (3 or 4, S, S)."""
    channels = torch.from_numpy(normal).permute(2, 0, 1)
    return channels if confidence is None else torch.cat([channels, torch.from_numpy(confidence)[None]])
