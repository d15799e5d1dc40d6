"""Read OBJ files (Wavefront); polygons are not cut into triangles."""

from normalgan.rendering.polygons import BrokenMeshError, Polygons, decode_text, parse_points, polygons_of

__all__ = ["read_obj"]


def read_obj(data: bytes) -> Polygons:
    """Return the faces of an OBJ; curves, points and lines are passed over.

    Raises:
        BrokenMeshError: if a vertex or a face of it cannot be read.
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
    """Return the index of a corner; a negative one counts back from the last vertex so far."""
    try:
        number = int(word.partition("/")[0])
    except ValueError:
        raise BrokenMeshError(f"{line.strip()[:60]!r} is not a face") from None
    if number == 0 or number < -count:
        raise BrokenMeshError(
            f"a face refers to vertex {str(number)[:20]}, which is not there; OBJ counts from 1"
        )
    return number - 1 if number > 0 else count + number
