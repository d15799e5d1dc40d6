"""Weights files: tensors and metadata as safetensors or ONNX, which are checked before use."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import onnx
import torch
from onnx import numpy_helper
from onnx.external_data_helper import uses_external_data
from safetensors.torch import load, save
from torch import Tensor

from normalgan.errors import InputError, RunError, wants_memory
from normalgan.files.limits import read_named
from normalgan.models import GENERATORS, Generator
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.network import build_generator, check_fit, naming_model

_ONNX = ".onnx"
SUFFIXES = (".safetensors", _ONNX)
"""Extensions of files that hold weights without training state."""
_MOST_HEADER = 2**20  # names and shapes take a hundred bytes per tensor
_NETWORK, _HALF = "generator.", ".half"
_MEAN, _COUNT = "running_mean", "num_batches_tracked"
"""Parts of the names of tensors in an ONNX file."""
_SMALLEST_HALVED = 64  # smaller tensors take little space and keep their precision


@dataclass(frozen=True)
class Weights:
    """A generator as tensors by name, with its metadata.

    Args:
        notes: metadata of the model.
        tensors: parameters and statistics by name.
    """

    notes: ModelMetadata
    tensors: Mapping[str, Tensor]

    def generator(self) -> Generator:
        """Return the generator, in float32, ready to predict."""
        return build_generator(self.notes.generator, self.tensors)

    def load_into(self, generator: Generator) -> None:
        """Load the weights into a generator of the same class and settings, keeping its precision."""
        generator.load_state_dict(dict(self.tensors))

    def halved(self) -> "Weights":
        """Return the weights as float16, clamped to its range."""
        return Weights(self.notes, {name: _halve(tensor) for name, tensor in self.tensors.items()})

    def to_bytes(self) -> bytes:
        """Return the content of a safetensors file, identical for identical weights."""
        # Cloned, because tensors that share memory are refused.
        tensors = {
            name: tensor.clone(memory_format=torch.contiguous_format) for name, tensor in self.tensors.items()
        }
        header, numbers = _split(save(tensors, {"format": "pt"}))
        # The library writes the metadata in random order, so it is sorted here.
        header["__metadata__"] |= self.notes.metadata()
        text = json.dumps(header, sort_keys=True, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 8)  # alignment of the tensors
        return len(text).to_bytes(8, "little") + text + numbers


def parse_weights(content: bytes, name: str = "the file", is_onnx: bool = False) -> Weights:
    """Return the weights in the content of a file, without executing any of it.

    Args:
        content: content of the file.
        name: name of the file in error messages.
        is_onnx: whether the file is ONNX instead of safetensors.

    Raises:
        InputError: if the file is damaged or from another program, or its model cannot be built here.
    """
    try:
        metadata, tensors = (_parse_onnx if is_onnx else _parse_safetensors)(content)
    except Exception as error:  # each library raises errors of its own classes
        if wants_memory(error):
            raise RunError(f"there is too little memory to read {name}; close other programs.") from error
        raise InputError(
            f"{name} is damaged or no {'ONNX' if is_onnx else 'safetensors'}; give a file that "
            "`normalgan export` wrote."
        ) from None
    try:
        with naming_model(name):
            notes = ModelMetadata.parse(metadata)
            check_fit(notes.generator, tensors, GENERATORS)
    except KeyError:
        raise InputError(
            f"{name} holds weights of another program; give a file that `normalgan export` wrote."
        ) from None
    return Weights(notes, tensors)


def read_weights(path: Path) -> Weights:
    """Return the weights in a file.

    Raises:
        InputError: if the file is missing, cannot be read, or `parse_weights` refuses it.
    """
    if not path.is_file():
        raise InputError(f"there are no weights {path}; name a file that `normalgan export` wrote.")
    return parse_weights(read_named(path, "the weights"), str(path), path.suffix.lower() == _ONNX)


def _parse_onnx(content: bytes) -> tuple[dict[str, str], dict[str, Tensor]]:
    """Return the metadata of a file that `normalgan export` wrote, and the generator's tensors by name.

    The batch counters of batch norm are not in the graph and are set to 0.

    Raises:
        ValueError: if tensors are in other files. For damaged files, the package onnx raises its own errors.
    """
    model = onnx.load_from_string(content)
    tensors: dict[str, Tensor] = {}
    for stored in model.graph.initializer:
        if uses_external_data(stored):
            raise ValueError("tensors in other files")
        if not stored.name.startswith(_NETWORK):
            continue  # constants of the graph
        name = stored.name.removeprefix(_NETWORK).removesuffix(_HALF)
        tensors[name] = torch.from_numpy(numpy_helper.to_array(stored).copy())
        if name.endswith(_MEAN):
            tensors[name.removesuffix(_MEAN) + _COUNT] = torch.zeros((), dtype=torch.int64)
    return {each.key: each.value for each in model.metadata_props}, tensors


def _parse_safetensors(content: bytes) -> tuple[dict[str, str], dict[str, Tensor]]:
    """Return the metadata of a safetensors file, and its tensors by name."""
    header, _ = _split(content)
    return {str(k): str(v) for k, v in header.get("__metadata__", {}).items()}, load(content)


def _split(content: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the header of a safetensors file and the bytes after it.

    Raises:
        ValueError: if the header is too long or not text.
    """
    length = int.from_bytes(content[:8], "little")
    if length > _MOST_HEADER:
        raise ValueError(f"a header of {length} bytes")
    header: dict[str, Any] = json.loads(content[8 : 8 + length])
    return header, content[8 + length :]


def _halve(tensor: Tensor) -> Tensor:
    if not tensor.is_floating_point() or tensor.numel() < _SMALLEST_HALVED:
        return tensor
    largest = torch.finfo(torch.float16).max
    return tensor.clamp(-largest, largest).to(torch.float16)
