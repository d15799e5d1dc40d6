"""Accessors of glTF: arrays of all component types, including strided and sparse ones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.rendering.gltf.container import COMPONENTS, WIDTHS, Container, bad_gltf

_MOST_ELEMENTS = 2**26
"""Maximum number of elements, because an accessor may declare any number of zeros."""

_Array = NDArray[Any]


def read_accessor(container: Container, index: Any, kind: str) -> _Array:
    """Return the (count, width) numbers of an accessor of a type such as VEC3 (glTF 2.0, section 3.6.2).

    Normalised integers are returned as float64 in [0, 1] or [-1, 1], and others as stored. Matrices are in
    column-major order, as stored.

    Raises:
        InputError: if the accessor has another type, or exceeds its buffer.
    """
    entry = container.item("accessors", index)
    code, held, count = entry["componentType"], entry["type"], entry["count"]
    if held != kind or code not in COMPONENTS:
        raise bad_gltf(container.path, f"accessor {index} holds {held} of {code} where {kind} is needed")
    if type(count) is not int or not 1 <= count <= _MOST_ELEMENTS:
        raise bad_gltf(container.path, f"accessor {index} has {count} elements")
    dtype = np.dtype(COMPONENTS[code])
    if "bufferView" in entry:
        values = _view(
            container, entry["bufferView"], entry.get("byteOffset", 0), dtype, (count, WIDTHS[kind])
        )
    else:
        values = np.zeros((count, WIDTHS[kind]), dtype)
    if "sparse" in entry:
        values = _replaced(container, entry["sparse"], values)
    return _normalised(values) if entry.get("normalized", False) else values


def _view(
    container: Container, index: Any, offset: int, dtype: np.dtype[Any], shape: tuple[int, int]
) -> _Array:
    """Return the (count, width) elements at a byte offset in a buffer view."""
    view = container.item("bufferViews", index)
    container.item("buffers", view["buffer"])
    buffer, start = container.buffers[view["buffer"]], view.get("byteOffset", 0)
    count, width = shape
    stride = view.get("byteStride", width * dtype.itemsize)
    last = offset + (count - 1) * stride + width * dtype.itemsize
    if min(start, offset, stride) < 0 or last > view["byteLength"] or start + last > len(buffer):
        raise bad_gltf(container.path, f"buffer view {index} is too short for the numbers in it")
    return np.ndarray(shape, dtype, buffer, start + offset, (stride, dtype.itemsize))


def _replaced(container: Container, sparse: dict[str, Any], values: _Array) -> _Array:
    """Return the values with the replacements of a sparse accessor (section 3.6.2.3)."""
    count, places, given = sparse["count"], sparse["indices"], sparse["values"]
    where = _view(
        container,
        places["bufferView"],
        places.get("byteOffset", 0),
        np.dtype(COMPONENTS[places["componentType"]]),
        (count, 1),
    )
    if where.max() >= len(values):
        raise bad_gltf(container.path, "a sparse accessor replaces a missing element")
    replaced = values.copy()
    replaced[where[:, 0]] = _view(
        container, given["bufferView"], given.get("byteOffset", 0), values.dtype, (count, values.shape[1])
    )
    return replaced


def _normalised(values: _Array) -> _Array:
    """Return normalised integers as floats (section 3.11)."""
    if values.dtype.kind == "f":
        return values
    return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
