"""Reading of PLY files (Stanford), text and binary, without triangulating polygons."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.polygons import BrokenMeshError, Polygons, decode_text, parse_points, polygons_of

_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_FACES = ("vertex_indices", "vertex_index")
"""Names of the property that lists a face's corners."""


def read_ply(data: bytes) -> Polygons:
    """Return the faces of a text or binary PLY.

    Raises:
        BrokenMeshError: if the data violate the format.

    References:
        Turk 1994, "The PLY polygon file format".
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff", b"\xef\xbb\xbf")):  # text with a byte order mark
        data = decode_text(data).encode("ascii", "replace")
    head, end, body = data.partition(b"end_header")
    if not data.startswith(b"ply") or not end:
        raise BrokenMeshError("it has no header of a PLY")
    order, elements = _header(head.decode("ascii", "replace"))
    if order is None:
        raise BrokenMeshError("it does not say whether it is ascii or binary")
    body = body[body.find(b"\n") + 1 :]
    source = _Text(body) if not order else _Binary(body, order)
    vertices, faces = np.zeros((0, 3)), (np.zeros(0, np.int64),) * 2
    for name, count, properties in elements:
        if name == "vertex":
            vertices = source.table(count, properties)
        elif name == "face":
            faces = source.lists(count, properties)
        else:
            source.skip(count, properties)
    return Polygons(vertices, *faces)


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str
    length: str | None = None
    """The dtype of a list's length; None for a single value."""


def _header(text: str) -> tuple[str | None, list[tuple[str, int, list[_Property]]]]:
    order: str | None = None
    elements: list[tuple[str, int, list[_Property]]] = []
    for line in text.splitlines()[1:]:
        match line.split():
            case ["format", kind, *_] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if count.isdecimal() and len(count) < 16:
                elements.append((name, int(count), []))
            case ["property", "list", length, kind, name] if (
                elements and kind in _TYPES and _TYPES.get(length, "f")[0] != "f"
            ):
                elements[-1][2].append(_Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1][2].append(_Property(name, _TYPES[kind]))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise BrokenMeshError(f"its header has the line {line.strip()[:60]!r}")
    return order, elements


def _corner_list(properties: Sequence[_Property]) -> int:
    """Return the index of the face property that lists the corners."""
    lists = [number for number, each in enumerate(properties) if each.length is not None]
    named = [number for number in lists if properties[number].name in _FACES]
    if not (named or len(lists) == 1):
        raise BrokenMeshError(f"its faces have no list {_FACES[0]}")
    return (named or lists)[0]


def _places(properties: Sequence[_Property]) -> list[int]:
    """Return the indices of the vertex properties x, y and z."""
    names = [each.name if each.length is None else "" for each in properties]
    if not {"x", "y", "z"} <= {*names}:
        raise BrokenMeshError("its vertices have no x, y and z")
    return [names.index(axis) for axis in "xyz"]


class _Text:
    """The body of a text PLY, with one element per line."""

    def __init__(self, body: bytes) -> None:
        self._lines = [line for line in body.decode("ascii", "replace").splitlines() if line.strip()]
        self._at = 0

    def skip(self, count: int, properties: Sequence[_Property]) -> None:
        """Skip elements; elements without properties have no line."""
        self._at += count if properties else 0

    def table(self, count: int, properties: Sequence[_Property]) -> Doubles:
        """Return the positions (V, 3) of vertices."""
        places = _places(properties)
        if any(each.length is not None for each in properties):
            raise BrokenMeshError("its vertices have lists")
        rows = self._rows(count, len(properties))
        return parse_points([[row[place] for place in places] for row in rows])

    def lists(self, count: int, properties: Sequence[_Property]) -> tuple[Indices, Indices]:
        """Return the corners of faces, and the number of corners of each face."""
        wanted, faces = _corner_list(properties), []
        for row in self._rows(count, len(properties)):
            at = 0
            for number, each in enumerate(properties):
                length = 1
                if each.length is not None:
                    length, at = _whole(row[at] if at < len(row) else ""), at + 1
                if not 0 <= length <= len(row) - at:
                    raise BrokenMeshError(f"a face declares {length} corners and lists {len(row) - at}")
                if number == wanted:
                    faces.append([_whole(word) for word in row[at : at + length]])
                at += length
        found = polygons_of(np.zeros((0, 3)), faces)
        return found.corners, found.sizes

    def _rows(self, count: int, least: int) -> Iterator[list[str]]:
        lines = self._lines[self._at : self._at + count]
        self._at += count
        if len(lines) < count:
            raise BrokenMeshError(f"it ends after {len(lines)} of {count} elements (is it truncated?)")
        for line in lines:
            words = line.split()
            if len(words) < least:
                raise BrokenMeshError(f"its line {line[:60]!r} has too few numbers")
            yield words


def _whole(word: str) -> int:
    try:
        return int(float(word))
    except (ValueError, OverflowError):
        raise BrokenMeshError(f"{word[:20]!r} is not a whole number") from None


class _Binary:
    """The body of a binary PLY."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._at = body, order, 0

    def skip(self, count: int, properties: Sequence[_Property]) -> None:
        """Skip elements."""
        if properties:
            self._read(count, properties)

    def table(self, count: int, properties: Sequence[_Property]) -> Doubles:
        """Return the positions (V, 3) of vertices."""
        columns = self._read(count, properties)
        return np.stack([np.asarray(columns[each][0], np.float64) for each in _places(properties)], axis=-1)

    def lists(self, count: int, properties: Sequence[_Property]) -> tuple[Indices, Indices]:
        """Return the corners of faces, and the number of corners of each face."""
        corners, sizes = self._read(count, properties)[_corner_list(properties)]
        return np.asarray(corners, np.int64), sizes

    def _read(self, count: int, properties: Sequence[_Property]) -> list[tuple[NDArray[Any], Indices]]:
        """Return, for each property, its values and their number per element."""
        if not count:
            return [(np.zeros(0), np.zeros(0, np.int64)) for _ in properties]
        if self._at + count > len(self._body):  # each has at least one byte
            raise BrokenMeshError(f"it declares {count} elements in fewer bytes (is it truncated?)")
        lengths = self._lengths(properties, self._at)
        dtype = self._dtype(properties, lengths)
        if self._at + count * dtype.itemsize <= len(self._body):
            rows = np.frombuffer(self._body, dtype, count, self._at)
            alike = all(
                (rows[f"n{number}"] == lengths[number]).all()
                for number, each in enumerate(properties)
                if each.length is not None
            )
            if alike:
                self._at += count * dtype.itemsize
                return [
                    (rows[f"v{number}"].ravel(), np.full(count, lengths[number], np.int64))
                    for number in range(len(properties))
                ]
        return self._walk(count, properties)

    def _walk(self, count: int, properties: Sequence[_Property]) -> list[tuple[NDArray[Any], Indices]]:
        """Read elements one by one, because their lists differ in length."""
        sizes = np.ones((len(properties), count), np.int64)
        values: list[list[NDArray[Any]]] = [[] for _ in properties]
        for row in range(count):
            lengths = self._lengths(properties, self._at)
            dtype = self._dtype(properties, lengths)
            (found,) = np.frombuffer(self._body, dtype, 1, self._at)
            self._at += dtype.itemsize
            for number, length in enumerate(lengths):
                sizes[number, row] = length
                values[number].append(np.ravel(found[f"v{number}"]))
        return [(np.concatenate(each), own) for each, own in zip(values, sizes, strict=True)]

    def _lengths(self, properties: Sequence[_Property], at: int) -> list[int]:
        """Return the number of values per property of the element at a byte offset."""
        lengths = []
        for each in properties:
            length = 1
            if each.length is not None:
                kind = np.dtype(self._order + each.length)
                if at + kind.itemsize > len(self._body):
                    raise BrokenMeshError("it ends within an element (is it truncated?)")
                length, at = int(np.frombuffer(self._body, kind, 1, at)[0]), at + kind.itemsize
            at += length * np.dtype(each.kind).itemsize
            if length < 0 or at > len(self._body):
                raise BrokenMeshError(f"an element declares {length} values, and it ends before")
            lengths.append(length)
        return lengths

    def _dtype(self, properties: Sequence[_Property], lengths: Sequence[int]) -> np.dtype[Any]:
        fields: list[Any] = []
        for number, (each, length) in enumerate(zip(properties, lengths, strict=True)):
            if each.length is not None:
                fields.append((f"n{number}", self._order + each.length))
            fields.append((f"v{number}", self._order + each.kind, (length,)))
        return np.dtype(fields)
