"""ONNX files: metadata, half-precision weights and opset conversion."""

from collections.abc import Container, Mapping

import numpy as np
import onnx
from onnx import ModelProto, NodeProto, TensorProto, helper, numpy_helper, version_converter
from onnxscript import optimizer

from normalgan.errors import InputError, brief

_SMALL = 64
"""Smaller tensors, such as shapes and scales, keep their type because they take little space."""


def fold_constants(model: ModelProto, weights: Container[str]) -> ModelProto:
    """Return a model with constant subexpressions folded, but none of the named weights.

    A folded weight could not be read back from the file.
    """
    done = ModelProto()
    done.CopyFrom(model)
    optimizer.fold_constants(
        done,
        should_fold=lambda node: (
            False if any(each is not None and each.name in weights for each in node.inputs) else None
        ),
    )
    optimizer.remove_unused_nodes(done)
    return done


def finish(model: ModelProto, notes: Mapping[str, str]) -> bytes:
    """Return a model as bytes, with notes in ``metadata_props`` and without traces of this machine.

    Raises:
        onnx.checker.ValidationError: if the model is invalid.
    """
    done = ModelProto()
    done.CopyFrom(model)
    # torch stores in every node the source lines that it came from, with their paths.
    for node in done.graph.node:
        del node.metadata_props[:]
        node.doc_string = ""
    for value in (*done.graph.value_info, *done.graph.input, *done.graph.output, *done.graph.initializer):
        del value.metadata_props[:]
        value.doc_string = ""
    del done.graph.metadata_props[:]
    done.doc_string = done.graph.doc_string = ""
    done.graph.name, done.producer_name, done.producer_version = "normalgan", "normalgan", ""
    del done.metadata_props[:]
    helper.set_model_props(done, dict(notes))
    onnx.checker.check_model(done, full_check=True)
    return bytes(done.SerializeToString(deterministic=True))


def to_float16(content: bytes) -> bytes:
    """Return a model with weights stored as float16 and computation in float32.

    A cast node converts each weight back to float32, which ONNX Runtime does once when it loads the model.
    The file is half as large, and prediction is as fast on processors that only compute in float32.
    """
    model = onnx.load_from_string(content)
    casts: list[NodeProto] = []
    for weight in model.graph.initializer:
        if weight.data_type != TensorProto.FLOAT or np.prod(weight.dims) < _SMALL:
            continue
        name = weight.name
        values = numpy_helper.to_array(weight)
        largest = np.finfo(np.float16).max
        weight.CopyFrom(
            numpy_helper.from_array(np.clip(values, -largest, largest).astype(np.float16), f"{name}.half")
        )
        casts.append(
            helper.make_node("Cast", [f"{name}.half"], [name], name=f"{name}.whole", to=TensorProto.FLOAT)
        )
    nodes = [*casts, *model.graph.node]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    onnx.checker.check_model(model, full_check=True)
    return bytes(model.SerializeToString(deterministic=True))


def lowered(content: bytes, opset: int) -> bytes:
    """Return a model converted to another opset version, for older or newer runtimes.

    Raises:
        InputError: if ONNX's converter does not support an operator of the model in that version.
    """
    model = onnx.load_from_string(content)
    for node in model.graph.node:  # new in version 18, and without effect if axes are given
        kept = [each for each in node.attribute if each.name != "noop_with_empty_axes"]
        del node.attribute[:]
        node.attribute.extend(kept)
    try:
        converted = version_converter.convert_version(model, opset)
        onnx.checker.check_model(converted, full_check=True)
    except (RuntimeError, onnx.checker.ValidationError) as error:
        raise InputError(f"the model cannot be written with opset {opset}: {brief(error)}.") from None
    del converted.metadata_props[:]
    helper.set_model_props(converted, {each.key: each.value for each in model.metadata_props})
    return bytes(converted.SerializeToString(deterministic=True))
