"""Polygons: faces with any number of corners, read from OBJ and OFF files and triangulated.

trimesh's readers of OBJ, OFF and PLY always triangulate faces as fans, which is wrong for concave faces.
They also refuse a binary PLY with faces that differ in their number of corners.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from normalgan.arrays import BoolMask, Doubles, Indices

_MOST_CORNERS = 2**14
"""Maximum number of corners of a concave face, because triangulation takes quadratic time."""
_STRAIGHT = 1e-4
"""Sine of the tolerance angle for a concave corner, which allows for rounding."""


class BrokenMeshError(ValueError):
    """Error for a mesh file that violates its format; the message follows the file's name and a colon."""


@dataclass(frozen=True)
class Polygons:
    """Faces with any number of corners.

    Args:
        vertices: (V, 3) positions.
        corners: (C,) concatenated vertex indices of all faces.
        sizes: (F,) number of corners of each face.
    """

    vertices: Doubles
    corners: Indices
    sizes: Indices

    def triangles(self) -> Indices:
        """Return the faces as triangles (T, 3) with the same winding; faces of 2 corners are dropped.

        Convex faces become fans. Concave faces are triangulated by ear clipping.

        Raises:
            BrokenMeshError: if a face refers to a missing vertex, or a concave face has too many corners.

        References:
            Held 2001, "FIST: Fast industrial-strength triangulation of polygons", Algorithmica 30; the
            library is mapbox-earcut.

        Example:
            An arrow is split at its inward corner, index 0:

            >>> arrow = np.array([[0, 0, 0], [4, -4, 0], [0, 4, 0], [-4, -4, 0]], float)
            >>> faces = Polygons(arrow, np.array([1, 2, 3, 0]), np.array([4])).triangles()
            >>> [0 in face for face in faces]
            [True, True]
        """
        if len(self.corners) and not (0 <= self.corners.min() <= self.corners.max() < len(self.vertices)):
            raise BrokenMeshError("a face refers to a missing vertex (is it truncated?)")
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
            if len(cut):  # a degenerate face has no normal
                place = slice(firsts[number], firsts[number] + counts[number])
                faces[place][: len(cut)] = cut
                kept[place][len(cut) :] = False
        return np.asarray(faces[kept])

    def _concave(self, starts: Indices) -> Indices:
        """Return the indices of concave faces with more than three corners."""
        large = np.flatnonzero(self.sizes > 3)
        if not len(large):
            return large
        sizes = self.sizes[large]
        own = np.repeat(np.arange(len(large)), sizes)
        first = np.cumsum(sizes) - sizes
        position = np.arange(len(own)) - first[own]
        where = starts[large][own]
        with np.errstate(invalid="ignore", over="ignore"):  # nan is refused later
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
    """Return the triangles (T, 3) of a polygon (C, 3) as indices of its corners, with the same winding."""
    if len(points) > _MOST_CORNERS:
        raise BrokenMeshError(f"a concave face has {len(points)} corners; up to {_MOST_CORNERS} can be read")
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
    """Return a polygon (C, 3) as viewed from its front, (C, 2), counter-clockwise (Newell's normal)."""
    points = points - points[0]
    size = np.abs(points).max()
    points = points / (size if size > 0 else 1.0)
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    normal /= max(np.linalg.norm(normal), 1e-300)
    right = np.cross(np.eye(3)[np.abs(normal).argmin()], normal)
    right /= max(np.linalg.norm(right), 1e-300)
    return np.ascontiguousarray(points @ np.stack([right, np.cross(normal, right)], axis=-1))


def polygons_of(vertices: Doubles, faces: Sequence[Sequence[int]]) -> Polygons:
    """Return polygons for faces that are given as lists of corners."""
    sizes = np.fromiter(map(len, faces), np.int64, len(faces))
    try:
        corners = np.fromiter(chain.from_iterable(faces), np.int64, int(sizes.sum()))
    except OverflowError:
        raise BrokenMeshError("a face refers to a missing vertex") from None
    return Polygons(vertices, corners, sizes)


def parse_points(rows: Sequence[Sequence[str]], start: str = "") -> Doubles:
    """Return rows of three numbers as an array (V, 3)."""
    if all(len(row) == 3 for row in rows):
        try:
            return np.array(rows, np.float64).reshape(-1, 3)
        except ValueError:
            pass
    bad = next(row for row in rows if not _is_point(row))
    raise BrokenMeshError(f"{(start + ' '.join(bad))[:60]!r} is not a vertex, which has three numbers")


def _is_point(row: Sequence[str]) -> bool:
    try:
        return len([float(word) for word in row]) == 3
    except ValueError:
        return False


def decode_text(data: bytes) -> str:
    """Return the text of a file, ASCII or Unicode with a byte order mark, with newline line endings."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = data.decode("utf-16", "replace")
    else:
        text = data.removeprefix(b"\xef\xbb\xbf").decode("ascii", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_obj(data: bytes) -> Polygons:
    """Return the faces of an OBJ; curves, points and lines are ignored.

    Raises:
        BrokenMeshError: if a vertex or a face cannot be read.
    """
    vertices: list[list[str]] = []
    faces: list[list[int]] = []
    for line in decode_text(data).replace("\\\n", " ").split("\n"):
        kind, _, rest = line.strip().partition(" ")
        if kind == "v":
            vertices.append(rest.split()[:3])
        elif kind == "f":
            faces.append([_corner(word, len(vertices), line) for word in rest.partition("#")[0].split()])
    return polygons_of(parse_points(vertices, "v "), faces)


def _corner(word: str, count: int, line: str) -> int:
    """Return the vertex index of a corner; negative numbers count back from the last vertex so far."""
    try:
        number = int(word.partition("/")[0])
    except ValueError:
        raise BrokenMeshError(f"{line.strip()[:60]!r} is not a face") from None
    if number == 0 or number < -count:
        raise BrokenMeshError(
            f"a face refers to vertex {str(number)[:20]}, which is missing; OBJ counts from 1"
        )
    return number - 1 if number > 0 else count + number


def read_off(data: bytes) -> Polygons:
    """Return the faces of an OFF, COFF (with colours) or NOFF (with normals).

    Raises:
        BrokenMeshError: if the data violate the format.

    References:
        Geomview manual, "OFF files".
    """
    text = re.sub(r"#[^\n]*", "", decode_text(data))
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
            f"it declares {count} vertices and {faces} faces in {len(lines) - 1} lines (is it truncated?)"
        )
    given = [_face(words) for words in lines[count + 1 : count + faces + 1]]
    return polygons_of(parse_points([words[:3] for words in lines[1 : count + 1]]), given)


def _face(words: Sequence[str]) -> list[int]:
    """Return the corners in a face line of an OFF: their number, the corners and an optional colour."""
    try:
        count = int(words[0])
        if 0 <= count < len(words):
            return [int(word) for word in words[1 : count + 1]]
    except ValueError:
        raise BrokenMeshError(f"{' '.join(words)[:60]!r} is not a face") from None
    raise BrokenMeshError(f"a face declares {str(count)[:20]} corners and lists {len(words) - 1}")
