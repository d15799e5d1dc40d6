"""Polygons of mesh files: OBJ, OFF and PLY with their faces whole, cut into triangles that lie inside them.

trimesh's readers of these formats cut each face into a fan before anybody sees it, which fills in what a
concave face leaves out.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Doubles, Indices

__all__ = [
    "MOST_CORNERS",
    "READERS",
    "BrokenMeshError",
    "Polygons",
    "read_obj",
    "read_off",
    "read_ply",
]

MOST_CORNERS = 2**14
"""More corners of a concave face are refused: cutting one takes up to the square of their number."""
_STRAIGHT = 1e-4
"""Sine of an angle by which a corner may turn inwards without making its face concave: rounding."""
_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_FACES = ("vertex_indices", "vertex_index")
"""What writers call the list of a face's corners."""


class BrokenMeshError(ValueError):
    """A mesh file that violates its format; its text goes after the file's name and a colon."""


@dataclass(frozen=True)
class Polygons:
    """Faces of any number of corners.

    Args:
        vertices: (V, 3) positions.
        corners: (C,) vertex indices of all faces, one face after the other.
        sizes: (F,) corners of each face.
    """

    vertices: Doubles
    corners: Indices
    sizes: Indices

    def triangles(self) -> Indices:
        """Return the faces as triangles (T, 3), wound as they are; faces of fewer than 3 corners have none.

        Convex faces become fans. Concave ones are cut by ear clipping.

        Raises:
            BrokenMeshError: if a face refers to a vertex that is not there, or a concave one has too many
                corners.

        References:
            Held 2001, "FIST: Fast industrial-strength triangulation of polygons", Algorithmica 30; the
            library is mapbox-earcut.

        Example:
            An arrow is cut at its inward corner, number 0:

            >>> arrow = np.array([[0, 0, 0], [4, -4, 0], [0, 4, 0], [-4, -4, 0]], float)
            >>> faces = Polygons(arrow, np.array([1, 2, 3, 0]), np.array([4])).triangles()
            >>> [0 in face for face in faces]
            [True, True]
        """
        if len(self.corners) and not (0 <= self.corners.min() <= self.corners.max() < len(self.vertices)):
            raise BrokenMeshError("a face refers to a vertex that is not there (is it truncated?)")
        starts = np.cumsum(self.sizes) - self.sizes
        counts = np.maximum(self.sizes - 2, 0)
        firsts = np.cumsum(counts) - counts
        owners = np.repeat(np.arange(len(counts)), counts)
        second = starts[owners] + np.arange(len(owners)) - firsts[owners] + 1
        faces = self.corners[np.stack([starts[owners], second, second + 1], axis=-1)]
        kept = np.ones(len(faces), bool)
        for number in self._concave(starts):
            own = self.corners[starts[number] : starts[number] + self.sizes[number]]
            cut = own[_cut(self.vertices[own])]
            if len(cut):  # none of a face that is but a line
                place = slice(firsts[number], firsts[number] + counts[number])
                faces[place][: len(cut)] = cut
                kept[place][len(cut) :] = False
        return np.asarray(faces[kept])

    def _concave(self, starts: Indices) -> Indices:
        """Return the numbers of the faces of more than three corners that are concave."""
        large = np.flatnonzero(self.sizes > 3)
        if not len(large):
            return large
        sizes = self.sizes[large]
        own = np.repeat(np.arange(len(large)), sizes)
        first = np.cumsum(sizes) - sizes
        position = np.arange(len(own)) - first[own]
        where = starts[large][own]
        with np.errstate(invalid="ignore", over="ignore"):  # not a number: refused later
            here = self.vertices[self.corners[where + position]]
            there = self.vertices[self.corners[where + (position + 1) % sizes[own]]]
            origin = self.vertices[self.corners[where]]
            area = np.add.reduceat(np.cross(here - origin, there - origin), first)
            edge = there - here
            before = edge[first[own] + (position - 1) % sizes[own]]
            length = np.linalg.norm(area, axis=1)[own] * _length(before) * _length(edge)
            turns = np.einsum("ij,ij->i", np.cross(before, edge), area[own])
        inward: BoolMask = turns < -_STRAIGHT * length
        return large[np.unique(own[inward])]


def _length(vectors: Doubles) -> Doubles:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _cut(points: Doubles) -> Indices:
    """Return the triangles (T, 3) of a polygon (C, 3), as numbers of its corners, wound as it is."""
    if len(points) > MOST_CORNERS:
        raise BrokenMeshError(f"a concave face has {len(points)} corners; up to {MOST_CORNERS} can be read")
    import mapbox_earcut

    flat = _flattened(points)
    if not np.isfinite(flat).all():
        return np.zeros((0, 3), np.int64)
    found = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32))
    faces = np.asarray(found, np.int64).reshape(-1, 3)
    a, b, c = (flat[faces[:, i]] for i in range(3))
    (across, up), (over, along) = (b - a).T, (c - a).T
    return faces[:, ::-1] if (across * along - up * over).sum() < 0 else faces


def _flattened(points: Doubles) -> Doubles:
    """Return a polygon (C, 3) seen from its front, (C, 2), counter-clockwise (Newell's normal)."""
    points = points - points[0]
    size = np.abs(points).max()
    points = points / (size if size > 0 else 1.0)
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    normal /= max(np.linalg.norm(normal), 1e-300)
    right = np.cross(np.eye(3)[np.abs(normal).argmin()], normal)
    right /= max(np.linalg.norm(right), 1e-300)
    return np.ascontiguousarray(points @ np.stack([right, np.cross(normal, right)], axis=-1))


def _gathered(vertices: Doubles, faces: Sequence[Sequence[int]]) -> Polygons:
    sizes = np.fromiter(map(len, faces), np.int64, len(faces))
    try:
        corners = np.fromiter(chain.from_iterable(faces), np.int64, int(sizes.sum()))
    except OverflowError:
        raise BrokenMeshError("a face refers to a vertex that is not there") from None
    return Polygons(vertices, corners, sizes)


def read_obj(data: bytes) -> Polygons:
    """Return the faces of an OBJ; curves, points and lines are passed over.

    Raises:
        BrokenMeshError: if a vertex or a face of it cannot be read.
    """
    vertices: list[list[str]] = []
    faces: list[list[int]] = []
    for line in _text(data).replace("\\\n", " ").split("\n"):
        kind, _, rest = line.strip().partition(" ")
        if kind == "v":
            vertices.append(rest.split()[:3])
        elif kind == "f":
            faces.append([_corner(word, len(vertices), line) for word in rest.partition("#")[0].split()])
    return _gathered(_numbers(vertices, "v "), faces)


def _corner(word: str, count: int, line: str) -> int:
    """Return the index of a corner; one that is negative counts back from the last vertex so far."""
    try:
        number = int(word.partition("/")[0])
    except ValueError:
        raise BrokenMeshError(f"{line.strip()[:60]!r} is no face") from None
    if number == 0 or number < -count:
        raise BrokenMeshError(
            f"a face refers to vertex {str(number)[:20]}, which is not there; OBJ counts from 1"
        )
    return number - 1 if number > 0 else count + number


def _numbers(rows: Sequence[Sequence[str]], start: str = "") -> Doubles:
    """Return rows of three numbers as an array (V, 3)."""
    if all(len(row) == 3 for row in rows):
        try:
            return np.array(rows, np.float64).reshape(-1, 3)
        except ValueError:
            pass
    bad = next(row for row in rows if not _is_point(row))
    raise BrokenMeshError(f"{(start + ' '.join(bad))[:60]!r} is no vertex, which has three numbers")


def _is_point(row: Sequence[str]) -> bool:
    try:
        return len([float(word) for word in row]) == 3
    except ValueError:
        return False


def read_off(data: bytes) -> Polygons:
    """Return the faces of an OFF, also of one with colours or normals (COFF, NOFF).

    Raises:
        BrokenMeshError: if it violates the format.

    References:
        Geomview manual, "OFF files".
    """
    text = re.sub(r"#[^\n]*", "", _text(data))
    found = re.match(r"\s*(\w*?)OFF(\s*BINARY)?", text)
    if found is None:
        raise BrokenMeshError("it does not begin with OFF")
    if found[2] or not re.fullmatch("(ST)?C?N?", found[1]):
        kind = found[0].strip()
        raise BrokenMeshError(f"it is an OFF of the kind {kind[:20]}; OFF, COFF and NOFF as text can be read")
    lines = [line.split() for line in text[found.end() :].split("\n") if line.strip()]
    try:
        count, faces = (int(word) for word in lines[0][:2])
    except (ValueError, IndexError):
        raise BrokenMeshError("it does not say how many vertices and faces it has") from None
    if not (count >= 0 and faces >= 0 and count + faces < len(lines)):
        raise BrokenMeshError(
            f"it announces {count} vertices and {faces} faces in {len(lines) - 1} lines (is it truncated?)"
        )
    given = [_face(words) for words in lines[count + 1 : count + faces + 1]]
    return _gathered(_numbers([words[:3] for words in lines[1 : count + 1]]), given)


def _face(words: Sequence[str]) -> list[int]:
    """Return the corners of a line of an OFF: how many they are, these, and perhaps a colour."""
    try:
        count = int(words[0])
        if 0 <= count < len(words):
            return [int(word) for word in words[1 : count + 1]]
    except ValueError:
        raise BrokenMeshError(f"{' '.join(words)[:60]!r} is no face") from None
    raise BrokenMeshError(f"a face announces {str(count)[:20]} corners and lists {len(words) - 1}")


def read_ply(data: bytes) -> Polygons:
    """Return the faces of a PLY, as text or binary.

    Raises:
        BrokenMeshError: if it violates the format.

    References:
        Turk 1994, "The PLY polygon file format".
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff", b"\xef\xbb\xbf")):  # text of a program that marks it
        data = _text(data).encode("ascii", "replace")
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
    """The type of a list's length; None of a single value."""


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
    """Return which of the properties of a face lists its corners."""
    lists = [number for number, each in enumerate(properties) if each.length is not None]
    named = [number for number in lists if properties[number].name in _FACES]
    if not (named or len(lists) == 1):
        raise BrokenMeshError(f"its faces have no list {_FACES[0]}")
    return (named or lists)[0]


def _places(properties: Sequence[_Property]) -> list[int]:
    """Return which properties of a vertex are x, y and z."""
    names = [each.name if each.length is None else "" for each in properties]
    if not {"x", "y", "z"} <= {*names}:
        raise BrokenMeshError("its vertices have no x, y and z")
    return [names.index(axis) for axis in "xyz"]


class _Text:
    """The body of a PLY as text: an element a line."""

    def __init__(self, body: bytes) -> None:
        self._lines = [line for line in body.decode("ascii", "replace").splitlines() if line.strip()]
        self._at = 0

    def skip(self, count: int, properties: Sequence[_Property]) -> None:
        """Skip elements; those without a property have no line."""
        self._at += count if properties else 0

    def table(self, count: int, properties: Sequence[_Property]) -> Doubles:
        """Return the places (V, 3) of vertices."""
        places = _places(properties)
        if any(each.length is not None for each in properties):
            raise BrokenMeshError("its vertices have lists")
        rows = self._rows(count, len(properties))
        return _numbers([[row[place] for place in places] for row in rows])

    def lists(self, count: int, properties: Sequence[_Property]) -> tuple[Indices, Indices]:
        """Return the corners of faces, and how many each has."""
        wanted, faces = _corner_list(properties), []
        for row in self._rows(count, len(properties)):
            at = 0
            for number, each in enumerate(properties):
                length = 1
                if each.length is not None:
                    length, at = _whole(row[at] if at < len(row) else ""), at + 1
                if not 0 <= length <= len(row) - at:
                    raise BrokenMeshError(f"a face announces {length} corners and lists {len(row) - at}")
                if number == wanted:
                    faces.append([_whole(word) for word in row[at : at + length]])
                at += length
        found = _gathered(np.zeros((0, 3)), faces)
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
        raise BrokenMeshError(f"{word[:20]!r} is no whole number") from None


class _Binary:
    """The body of a binary PLY."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._at = body, order, 0

    def skip(self, count: int, properties: Sequence[_Property]) -> None:
        """Skip elements."""
        if properties:
            self._read(count, properties)

    def table(self, count: int, properties: Sequence[_Property]) -> Doubles:
        """Return the places (V, 3) of vertices."""
        columns = self._read(count, properties)
        return np.stack([np.asarray(columns[each][0], np.float64) for each in _places(properties)], axis=-1)

    def lists(self, count: int, properties: Sequence[_Property]) -> tuple[Indices, Indices]:
        """Return the corners of faces, and how many each has."""
        corners, sizes = self._read(count, properties)[_corner_list(properties)]
        return np.asarray(corners, np.int64), sizes

    def _read(self, count: int, properties: Sequence[_Property]) -> list[tuple[NDArray[Any], Indices]]:
        """Return for each property its values, and how many each element has of it."""
        if not count:
            return [(np.zeros(0), np.zeros(0, np.int64)) for _ in properties]
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
        """Read elements one by one, because their lists have several lengths."""
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
        """Return how many values the element that begins at a byte has of each property."""
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
                raise BrokenMeshError(f"an element announces {length} values, and it ends before")
            lengths.append(length)
        return lengths

    def _dtype(self, properties: Sequence[_Property], lengths: Sequence[int]) -> np.dtype[Any]:
        fields: list[Any] = []
        for number, (each, length) in enumerate(zip(properties, lengths, strict=True)):
            if each.length is not None:
                fields.append((f"n{number}", self._order + each.length))
            fields.append((f"v{number}", self._order + each.kind, (length,)))
        return np.dtype(fields)


def _text(data: bytes) -> str:
    """Return the text of a file: ASCII, or Unicode that a mark at its start tells; lines end in a newline."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = data.decode("utf-16", "replace")
    else:
        text = data.removeprefix(b"\xef\xbb\xbf").decode("ascii", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


READERS = {".obj": read_obj, ".off": read_off, ".ply": read_ply}
"""Readers of the formats that hold polygons, by suffix."""
