"""Export formats: writing a model as bytes, and running such bytes."""

import json
import logging
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO

import numpy as np
import torch
from torch import Tensor
from torch.export import Dim

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.exporting.deployed import Deployed
from normalgan.warning_filters import quiet_loggers
from normalgan.weights.file import Weights, parse_weights
from normalgan.weights.metadata import ModelMetadata

__all__ = [
    "FORMATS",
    "Format",
    "Run",
    "halve_onnx",
    "read_onnx",
    "read_program",
    "read_safetensors",
    "read_torchscript",
    "write_onnx",
    "write_program",
    "write_safetensors",
    "write_torchscript",
]

Run = Callable[[Floats, Floats], Sequence[Floats]]


@dataclass(frozen=True)
class Format:
    """A way to write a model.

    Args:
        write: makes the bytes from a model and its metadata.
        read: returns a function that predicts sketches with hints, from the bytes.
        halve: makes of the bytes those with weights in 16 bits; None where formats are not compared.
    """

    write: Callable[[Deployed, Mapping[str, str]], bytes]
    read: Callable[[bytes], Run]
    halve: Callable[[bytes], bytes] | None = None


def write_onnx(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as ONNX with any number of pictures a batch.

    Raises:
        InputError: if the packages for it are missing.
    """
    try:
        import onnxscript  # noqa: F401 -- torch's exporter asks for it late, and in many words
    except ImportError:
        raise InputError(
            "ONNX needs two more packages; install them with pip install 'normalgan[export]'."
        ) from None
    from normalgan.exporting.onnx_file import finish, fold_constants

    batch = {0: Dim.DYNAMIC}
    loggers = quiet_loggers("torch.onnx", "onnxscript", "onnx_ir", level=logging.ERROR)
    with warnings.catch_warnings(action="ignore"), loggers:  # between torch and its own parts
        program = torch.onnx.export(
            model,
            model.example(2),
            input_names=["sketch", "hints"],
            output_names=model.outputs,
            dynamic_shapes=(batch, batch),
            opset_version=18,  # of 2023: what onnxruntime-web and engines have taken up
            dynamo=True,
            optimize=False,  # it would merge batch norm into convolutions, from which no weights can be read
            verbose=False,
        )
    if program is None:
        raise RuntimeError("torch.onnx.export returned nothing")
    return finish(fold_constants(program.model_proto), notes)


def read_onnx(content: bytes) -> Run:
    """Return a model run by ONNX Runtime on the CPU."""
    import onnxruntime

    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    return lambda sketch, hints: [
        np.asarray(output) for output in session.run(None, {"sketch": sketch, "hints": hints})
    ]


def halve_onnx(content: bytes) -> bytes:
    """Return a model with its weights in 16 bits."""
    from normalgan.exporting.onnx_file import halve  # late: other formats do without the package onnx

    return halve(content)


def write_torchscript(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as TorchScript, traced, for libtorch without Python."""
    file = BytesIO()
    # torch calls it deprecated for torch.export, which old libtorch cannot read; tracing fixes the size.
    with warnings.catch_warnings(action="ignore"):
        traced = torch.jit.trace(model, model.example(2), check_trace=False)
        torch.jit.save(torch.jit.freeze(traced), file, _extra_files={"notes.json": json.dumps(dict(notes))})
    return file.getvalue()


def read_torchscript(content: bytes) -> Run:
    """Return a model run by TorchScript."""
    with warnings.catch_warnings(action="ignore"):
        return _tensors(torch.jit.load(BytesIO(content), map_location="cpu"))


def write_program(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as a program of ``torch.export``."""
    file, batch = BytesIO(), {0: Dim.DYNAMIC}
    with warnings.catch_warnings(action="ignore"):
        program = torch.export.export(model, model.example(2), dynamic_shapes=(batch, batch))
        torch.export.save(program, file, extra_files={"notes.json": json.dumps(dict(notes))})
    return file.getvalue()


def read_program(content: bytes) -> Run:
    """Return a model run by ``torch.export``."""
    with warnings.catch_warnings(action="ignore"):
        return _tensors(torch.export.load(BytesIO(content)).module())


def write_safetensors(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a generator's weights, with what this package needs to build it.

    Raises:
        InputError: if its settings are not plain enough for that.
    """
    return Weights(ModelMetadata.parse(notes), model.generator.state_dict()).to_bytes()


def read_safetensors(content: bytes) -> Run:
    """Return a generator built from such a file alone."""
    weights = parse_weights(content)
    return _tensors(Deployed(weights.generator(), weights.notes.size))


FORMATS = {  # by the ending of a file
    ".onnx": Format(write_onnx, read_onnx, halve_onnx),
    ".safetensors": Format(
        write_safetensors,
        read_safetensors,
        lambda content: parse_weights(content).halved().to_bytes(),
    ),
    ".pt": Format(write_torchscript, read_torchscript),
    ".pt2": Format(write_program, read_program),
}


def _tensors(module: Callable[[Tensor, Tensor], Sequence[Tensor]]) -> Run:
    def run(sketch: Floats, hints: Floats) -> Sequence[Floats]:
        with torch.no_grad():
            outputs = module(torch.from_numpy(sketch), torch.from_numpy(hints))
        return [output.numpy() for output in outputs]

    return run
