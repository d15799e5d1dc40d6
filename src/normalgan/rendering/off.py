"""Read OFF files (Geomview); polygons are not cut into triangles."""

import re
from collections.abc import Sequence

from normalgan.rendering.polygons import BrokenMeshError, Polygons, decode_text, parse_points, polygons_of

__all__ = ["read_off"]


def read_off(data: bytes) -> Polygons:
    """Return the faces of an OFF, also of one with colours or normals (COFF, NOFF).

    Raises:
        BrokenMeshError: if it violates the format.

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
    """Return the corners of a line of an OFF: how many they are, these, and an optional colour."""
    try:
        count = int(words[0])
        if 0 <= count < len(words):
            return [int(word) for word in words[1 : count + 1]]
    except ValueError:
        raise BrokenMeshError(f"{' '.join(words)[:60]!r} is not a face") from None
    raise BrokenMeshError(f"a face declares {str(count)[:20]} corners and lists {len(words) - 1}")
