"""Check the bytes of an ONNX file before ONNX Runtime loads it.

A generator is one graph without branches. Operators that run other graphs could run for ever, nested
functions could stand for any number of nodes, and external weights could be anyone's files.
"""

import math
from collections.abc import Iterator

from normalgan.errors import InputError

__all__ = ["MOST_NODES", "check_graph"]

MOST_NODES = 20_000
"""More operators than any generator has; a large one has some hundreds."""
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_DOMAINS = (b"", b"ai.onnx")
_FOLDED = {"Constant", "Cast", "Identity", "Reshape", "Transpose", "Squeeze", "Unsqueeze"}
"""Operators that make nothing larger than they are given."""


def check_graph(name: str, content: bytes) -> bool:
    """Look through an ONNX file, as deep as its format goes and without copies.

    The numbers below are those of the fields in ONNX's definition, onnx.proto.

    Args:
        name: what to call it in an error.
        content: the file.

    Returns:
        Whether what its weights alone decide may be computed on loading, which knows no limits: it may not
        if a small weight says how large a tensor is to be made.

    Raises:
        InputError: if it is not ONNX, or holds what no generator needs.
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
    """What a file holds that no generator needs."""


def _check_nodes(graph: memoryview) -> bool:
    """Return whether no constant computed from the weights is larger than they are."""
    count, given = 0, {_field(value, 1) for number, value in _fields(graph) if number == 11}
    given -= {_field(value, 8) for number, value in _fields(graph) if number == 5}  # a weight may be one too
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
    if math.prod(sides) > 2 * len(tensor):  # the smallest numbers take four bits
        raise _RefusedError(f"weights of {' × '.join(map(str, sides[:8]))} numbers, which are not there")


def _fields(message: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Yield the number and the bytes of each field of a protobuf message.

    Raises:
        ValueError: if it is not one.
        IndexError: if it is cut short.
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
    """Return a field of a message, empty if it has none."""
    return next((bytes(value) for found, value in _fields(message) if found == number), b"")


def _varint(message: memoryview, at: int) -> tuple[int, int]:
    """Return a whole number of variable length, and where it ends."""
    value = 0
    for shift in range(0, 70, 7):
        byte = message[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            return value, at
    raise ValueError("a number of more than ten bytes")


def _varints(values: memoryview) -> list[int]:
    """Return the numbers of a field, one or packed."""
    found, at = [], 0
    while at < len(values):
        value, at = _varint(values, at)
        found.append(value)
    return found


def _text(value: memoryview) -> str:
    text = bytes(value[:64]).decode("utf-8", "replace")
    return "".join(each for each in text if each.isprintable())
