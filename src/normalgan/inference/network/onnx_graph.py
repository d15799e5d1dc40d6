"""Check an ONNX file before ONNX Runtime loads it.

A generator is a single graph without control flow. Operators that run other graphs could loop forever, nested
functions could expand to any number of nodes, and external weights could be any file.
"""

import math
from collections.abc import Iterator

from normalgan.errors import InputError

MOST_NODES = 20_000
"""Maximum number of operators; a large generator has a few hundred."""
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_DOMAINS = (b"", b"ai.onnx")
_FOLDED = {"Constant", "Cast", "Identity", "Reshape", "Transpose", "Squeeze", "Unsqueeze"}
_FOLDED |= {"Slice", "DepthToSpace"}  # of the weights of convolutions of patches
"""Operators whose output is never larger than their input."""


def check_graph(name: str, content: bytes) -> bool:
    """Check an ONNX file and return whether constant folding is safe.

    The field numbers in this module are those of onnx.proto. The file is parsed without copies.

    Args:
        name: name of the file in error messages.
        content: content of the file.

    Returns:
        Whether constants may be folded when the model is loaded, which no memory limit covers. They may not
        if the value of a small weight can determine the size of a large tensor.

    Raises:
        InputError: if the file is not ONNX, or holds something that a generator does not need.
    """
    folds = True
    try:
        for number, value in _fields(memoryview(content)):
            if number == 7:
                folds &= _check_nodes(value)
            elif number in {20, 25}:
                raise _RefusedError("training steps" if number == 20 else "functions of its own")
    except _RefusedError as found:
        raise InputError(
            f"the model {name} holds {found}; a generator is one plain graph, as `normalgan export` writes."
        ) from None
    except (ValueError, IndexError):
        raise InputError(
            f"{name} is not a model that ONNX Runtime can run: it is not ONNX; `normalgan export` writes it."
        ) from None
    return folds


class _RefusedError(Exception):
    """Raised for a feature that a generator does not need; the message names the feature."""


def _check_nodes(graph: memoryview) -> bool:
    """Check the nodes of a graph; return whether all constants are at most as large as the weights."""
    count, given = 0, {_field(value, 1) for number, value in _fields(graph) if number == 11}
    # Weights may be listed as inputs too.
    given -= {_field(value, 8) for number, value in _fields(graph) if number == 5}
    folds = True
    for number, value in _fields(graph):
        match number:
            case 1:
                count += 1
                if count > MOST_NODES:
                    raise _RefusedError(f"more than {MOST_NODES} operators")
                _check_node(value)
                taken = {bytes(held) for kind, held in _fields(value) if kind == 1}
                if taken & given:
                    given |= {bytes(held) for kind, held in _fields(value) if kind == 2}
                else:
                    folds &= _field(value, 4).decode("utf-8", "replace") in _FOLDED
            case 5:
                _check_tensor(value)
            case 15:
                raise _RefusedError("sparse weights")
    return folds


def _check_node(node: memoryview) -> None:
    fields = list(_fields(node))
    operator = next((_text(value) for number, value in fields if number == 4), "?")
    for number, value in fields:
        if number == 7 and bytes(value[:64]) not in _DOMAINS:
            raise _RefusedError(f"the operator {operator} of {_text(value)}")
        if number != 5:
            continue
        for kind, held in _fields(value):
            if kind in {6, 11}:  # Loop, If, Scan, SequenceMap
                raise _RefusedError(f"the operator {operator}, which runs other graphs")
            if kind in {22, 23}:
                raise _RefusedError("sparse weights")
            if kind in {5, 10}:
                _check_tensor(held)


def _check_tensor(tensor: memoryview) -> None:
    sides: list[int] = []
    for number, value in _fields(tensor):
        if number == 1:
            sides += _varints(value)
        elif number == 13 or (number == 14 and _varints(value) != [0]):
            raise _RefusedError("weights that lie in another file")
    if math.prod(sides) > 2 * len(tensor):  # the smallest data type has four bits
        raise _RefusedError(f"weights of {' × '.join(map(str, sides[:8]))} numbers, which are not there")


def _fields(message: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Yield the number and the content of each field of a protobuf message.

    Raises:
        ValueError: if the bytes are not a protobuf message.
        IndexError: if the message is truncated.
    """
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        kind = key & 7
        if kind == _VARINT:
            start, at = at, _varint(message, at)[1]
        elif kind == _BYTES:
            length, start = _varint(message, at)
            at = start + length
        elif kind in {_FIXED64, _FIXED32}:
            start, at = at, at + (8 if kind == _FIXED64 else 4)
        else:
            raise ValueError("a group")
        if at > len(message):
            raise IndexError
        yield key >> 3, message[start:at]


def _field(message: memoryview, number: int) -> bytes:
    """Return the content of a message's field; empty if the message does not have the field."""
    return next((bytes(value) for found, value in _fields(message) if found == number), b"")


def _varint(message: memoryview, at: int) -> tuple[int, int]:
    """Return the varint at an offset, and the offset after it."""
    value = 0
    for shift in range(0, 70, 7):
        byte = message[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            return value, at
    raise ValueError("a number of more than ten bytes")


def _varints(values: memoryview) -> list[int]:
    """Return the numbers of a field of one varint or of packed varints."""
    found, at = [], 0
    while at < len(values):
        value, at = _varint(values, at)
        found.append(value)
    return found


def _text(value: memoryview) -> str:
    text = bytes(value[:64]).decode("utf-8", "replace")
    return "".join(each for each in text if each.isprintable())
