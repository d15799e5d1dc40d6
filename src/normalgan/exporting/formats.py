"""Export formats: writing a model as bytes, and running the bytes."""

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

Run = Callable[[Floats, Floats], Sequence[Floats]]


@dataclass(frozen=True)
class Format:
    """An export format.

    Args:
        write: converts a model and its metadata to bytes.
        read: converts the bytes to a function that predicts for sketches and hints.
        halve: converts the bytes to half-precision weights; None if the format has no such option.
    """

    write: Callable[[Deployed, Mapping[str, str]], bytes]
    read: Callable[[bytes], Run]
    halve: Callable[[bytes], bytes] | None = None


def write_onnx(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as ONNX with a dynamic batch size.

    Raises:
        InputError: if the packages for the export are missing.
    """
    try:
        import onnxscript  # noqa: F401 -- torch's exporter imports it late, with a long message if it is missing
    except ImportError:
        raise InputError(
            "ONNX needs two more packages; install them with pip install 'normalgan[export]'."
        ) from None
    from normalgan.exporting.onnx_file import finish, fold_constants

    batch = {0: Dim.DYNAMIC}
    loggers = quiet_loggers("torch.onnx", "onnxscript", "onnx_ir", level=logging.ERROR)
    with warnings.catch_warnings(action="ignore"), loggers:  # from torch's own modules
        program = torch.onnx.export(
            model,
            model.example(2),
            input_names=["sketch", "hints"],
            output_names=model.outputs,
            dynamic_shapes=(batch, batch),
            opset_version=18,  # of 2023, supported by onnxruntime-web
            dynamo=True,
            optimize=False,  # folding batch norm would make the weights unreadable
            verbose=False,
        )
    if program is None:
        raise RuntimeError("torch.onnx.export returned nothing")
    return finish(fold_constants(program.model_proto, model.state_dict()), notes)


def read_onnx(content: bytes) -> Run:
    """Return a function that runs the model in ONNX Runtime on the CPU."""
    import onnxruntime

    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    return lambda sketch, hints: [
        np.asarray(output) for output in session.run(None, {"sketch": sketch, "hints": hints})
    ]


def halve_onnx(content: bytes) -> bytes:
    """Return the model with 16-bit weights."""
    from normalgan.exporting.onnx_file import to_float16  # other formats do not need the package onnx

    return to_float16(content)


def write_torchscript(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as traced TorchScript, for libtorch without Python."""
    file = BytesIO()
    # Deprecated in favour of torch.export, which old libtorch cannot read. Tracing fixes the size.
    with warnings.catch_warnings(action="ignore"):
        traced = torch.jit.trace(model, model.example(2), check_trace=False)
        torch.jit.save(torch.jit.freeze(traced), file, _extra_files={"notes.json": json.dumps(dict(notes))})
    return file.getvalue()


def read_torchscript(content: bytes) -> Run:
    """Return a function that runs the TorchScript model."""
    with warnings.catch_warnings(action="ignore"):
        return _tensors(torch.jit.load(BytesIO(content), map_location="cpu"))


def write_program(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a model as a ``torch.export`` program."""
    file, batch = BytesIO(), {0: Dim.DYNAMIC}
    with warnings.catch_warnings(action="ignore"):
        program = torch.export.export(model, model.example(2), dynamic_shapes=(batch, batch))
        torch.export.save(program, file, extra_files={"notes.json": json.dumps(dict(notes))})
    return file.getvalue()


def read_program(content: bytes) -> Run:
    """Return a function that runs the ``torch.export`` program."""
    with warnings.catch_warnings(action="ignore"):
        return _tensors(torch.export.load(BytesIO(content)).module())


def write_safetensors(model: Deployed, notes: Mapping[str, str]) -> bytes:
    """Return a generator's weights, with the metadata that this package needs to rebuild it.

    Raises:
        InputError: if its settings are not plain values.
    """
    return Weights(ModelMetadata.parse(notes), model.generator.state_dict()).to_bytes()


def read_safetensors(content: bytes) -> Run:
    """Return a function that runs a generator rebuilt from the bytes alone."""
    weights = parse_weights(content)
    return _tensors(Deployed(weights.generator(), weights.notes.size))


FORMATS = {  # by file extension
    ".onnx": Format(write_onnx, read_onnx, halve_onnx),
    ".safetensors": Format(
        write_safetensors, read_safetensors, lambda content: parse_weights(content).halved().to_bytes()
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
