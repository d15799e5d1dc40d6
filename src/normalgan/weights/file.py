"""Weights as safetensors or in our ONNX files: tensors and notes; a stranger's file is checked before use."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import load, save
from torch import Tensor

from normalgan.errors import InputError, RunError, wants_memory
from normalgan.files.limits import read_named
from normalgan.models import GENERATORS, Generator
from normalgan.weights.metadata import ModelMetadata
from normalgan.weights.network import build_generator, check_fit
from normalgan.weights.onnx_tensors import parse_onnx

__all__ = ["SUFFIXES", "Weights", "parse_weights", "read_weights"]

_ONNX = ".onnx"
SUFFIXES = (".safetensors", _ONNX)
"""Endings of files that hold weights and no state of a training."""
_MOST_HEADER = 2**20  # of names and shapes, a hundred bytes a tensor
_SMALL = 64  # tensors of fewer elements weigh nothing, and are kept as they are


@dataclass(frozen=True)
class Weights:
    """A generator as tensors by name, with its metadata.

    Args:
        notes: what it is.
        tensors: its parameters and statistics.
    """

    notes: ModelMetadata
    tensors: Mapping[str, Tensor]

    def generator(self) -> Generator:
        """Return the generator, in float32, ready to predict."""
        return build_generator(self.notes.generator, self.tensors)

    def load_into(self, generator: Generator) -> None:
        """Give a generator of this kind these weights, each in its own precision."""
        generator.load_state_dict(dict(self.tensors))

    def halved(self) -> "Weights":
        """Return the weights in 16 bits, clamped to their range."""
        return Weights(self.notes, {name: _halve(tensor) for name, tensor in self.tensors.items()})

    def to_bytes(self) -> bytes:
        """Return the content of a file, the same for the same weights."""
        # Clones: tensors that share memory are refused.
        tensors = {
            name: tensor.clone(memory_format=torch.contiguous_format) for name, tensor in self.tensors.items()
        }
        header, numbers = _split(save(tensors, {"format": "pt"}))
        # The library writes notes in an order that changes from call to call; these are sorted.
        header["__metadata__"] |= self.notes.metadata()
        text = json.dumps(header, sort_keys=True, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 8)  # numbers are aligned so
        return len(text).to_bytes(8, "little") + text + numbers


def parse_weights(content: bytes, name: str = "the file", is_onnx: bool = False) -> Weights:
    """Return the weights in the content of a file; nothing in it is executed.

    Args:
        content: content of the file.
        name: name of the file, in error messages.
        is_onnx: whether it is ONNX and not safetensors.

    Raises:
        InputError: if it is damaged, or its model is not ours or cannot be built here.
    """
    try:
        metadata, tensors = (parse_onnx if is_onnx else _parse_safetensors)(content)
    except Exception as error:  # each library has its own classes of errors, and torch others
        if wants_memory(error):
            raise RunError(f"there is too little memory to read {name}; close other programs.") from error
        raise InputError(
            f"{name} is damaged or no {'ONNX' if is_onnx else 'safetensors'}; give a file that "
            "`normalgan export` wrote."
        ) from None
    try:
        notes = ModelMetadata.parse(metadata)
        check_fit(notes.generator, tensors, GENERATORS)
    except KeyError:
        raise InputError(
            f"{name} holds weights of another program; give a file that `normalgan export` wrote."
        ) from None
    except InputError as error:
        raise InputError(f"the model in {name} cannot be built here: {error}") from error
    return Weights(notes, tensors)


def read_weights(path: Path) -> Weights:
    """Return the weights in a file.

    Raises:
        InputError: if it is missing, cannot be read, or `parse_weights` refuses it.
    """
    if not path.is_file():
        raise InputError(f"there are no weights {path}; name a file that `normalgan export` wrote.")
    return parse_weights(read_named(path, "the weights"), str(path), path.suffix.lower() == _ONNX)


def _parse_safetensors(content: bytes) -> tuple[dict[str, str], dict[str, Tensor]]:
    """Return the notes in a file of safetensors, and its tensors by name."""
    header, _ = _split(content)
    return {str(k): str(v) for k, v in header.get("__metadata__", {}).items()}, load(content)


def _split(content: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the header of a file and its payload.

    Raises:
        ValueError: if it is longer than any header of ours, or no text.
    """
    length = int.from_bytes(content[:8], "little")
    if length > _MOST_HEADER:
        raise ValueError(f"a header of {length} bytes")
    header: dict[str, Any] = json.loads(content[8 : 8 + length])
    return header, content[8 + length :]


def _halve(tensor: Tensor) -> Tensor:
    if not tensor.is_floating_point() or tensor.numel() < _SMALL:
        return tensor
    largest = torch.finfo(torch.float16).max
    return tensor.clamp(-largest, largest).to(torch.float16)
