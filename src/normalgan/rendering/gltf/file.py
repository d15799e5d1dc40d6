"""The container of glTF 2.0: its JSON, and the binary chunk of a .glb."""

import json
import struct
from pathlib import Path
from typing import Any

from normalgan.rendering.mesh_bytes import mesh_bytes

__all__ = ["COMPONENTS", "WIDTHS", "read_gltf"]

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""The types of a component of an accessor, as NumPy names them."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Components of an element of each type of accessor."""

_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


def read_gltf(path: Path) -> tuple[dict[str, Any], bytes | None]:
    """Return the JSON of a .gltf or .glb, and the binary chunk of a .glb if it has one.

    References:
        Khronos Group 2021, "glTF 2.0 Specification", sections 3 and 4.4.

    Raises:
        InputError: if it is too large.
        ValueError, LookupError, struct.error, RecursionError: if it is not glTF.
    """
    data, binary = mesh_bytes(path), None
    if path.suffix.lower() == ".glb":
        chunks = _chunks(data)
        data, binary = chunks[_JSON], chunks.get(_BINARY)
    tree = json.loads(data)
    if not isinstance(tree, dict):
        raise ValueError("its JSON is not an object")
    return tree, binary


def _chunks(data: bytes) -> dict[int, bytes]:
    """Return the chunks of a .glb by their type."""
    magic, _, length = struct.unpack_from("<III", data)
    if magic != _MAGIC or length > len(data):
        raise ValueError("wrong header, or cut short")
    chunks: dict[int, bytes] = {}
    start = 12
    while start + 8 <= length:
        size, kind = struct.unpack_from("<II", data, start)
        chunks.setdefault(kind, data[start + 8 : start + 8 + size])
        start += 8 + size
    return chunks
