"""Limits of mesh files: check headers against the file's size before a parser trusts them."""

import os
import re
from collections import Counter
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.gltf.file import COMPONENTS, WIDTHS, read_gltf
from normalgan.rendering.mesh_bytes import mesh_bytes

__all__ = [
    "FREE_NUMBERS",
    "FREE_VERTICES",
    "HEADER",
    "MOST_PARTS",
    "REPEATED",
    "buffer_file",
    "check_limits",
    "linked_buffers",
    "name_in_folder",
]

HEADER = 2**16
"""Bytes of a file in which it has to say what it holds."""
FREE_NUMBERS = 2**22
"""Numbers that the accessors of a glTF may declare whatever its size; more need their bytes in the file."""
FREE_VERTICES = 2**18
"""The same of vertices in a scene, those of a repeated part counted each time."""
MOST_PARTS = 5_000
"""More nodes, or more placed parts of meshes, are refused: each takes trimesh a millisecond and more."""
REPEATED = 4
"""How often the bytes of a glTF may be used; nearly all exporters use them once."""


def check_limits(path: Path) -> None:
    """Check a mesh file before it is parsed.

    Args:
        path: an existing file in one of the formats of `SUFFIXES`.

    Raises:
        InputError: if it is too large, declares more than it can hold, or refers to something outside its
            folder.
        ValueError, LookupError, TypeError, AttributeError, struct.error: if it is not of its format.
    """
    match path.suffix.lower():
        case ".off" | ".ply":
            _check_header(path, mesh_bytes(path))
        case ".glb" | ".gltf":
            try:
                tree, _ = read_gltf(path)
            except RecursionError:
                raise InputError(f"{path} is nested more deeply than any mesh file.") from None
            held = len(mesh_bytes(path)) + sum(
                len(mesh_bytes(buffer)) for buffer in linked_buffers(path, tree)
            )
            _check_views(path, tree, held)
            _check_counts(path, tree, held)


def name_in_folder(uri: str) -> str | None:
    """Return the path that a URI names relative to its file's folder; None if it leads out of it.

    >>> name_in_folder("a%20b.bin"), name_in_folder("%2e%2e/b.bin"), name_in_folder("file:///etc/hostname")
    ('a b.bin', None, None)
    """
    try:
        parts = urlsplit(uri)
    except ValueError:  # half an IPv6 address
        return None
    name = Path(os.path.normpath(unquote(parts.path)))
    outside = parts.scheme or parts.netloc or name.is_absolute() or name.parts[:1] == ("..",)
    return None if outside or "\0" in str(name) else str(name)


def linked_buffers(path: Path, tree: dict[str, Any]) -> list[Path]:
    """Return the buffer files of a glTF that exist.

    Raises:
        InputError: if one does not lie in the folder of the glTF, or is a pipe or a device.
        AttributeError, TypeError: if its buffers are not as glTF 2.0 says.
    """
    uris = [buffer.get("uri", "") for buffer in tree.get("buffers", [])]
    found = [buffer_file(path, uri) for uri in uris if uri and not uri.startswith("data:")]
    return [file for file in found if file.is_file()]


def buffer_file(path: Path, uri: str) -> Path:
    """Return the file that a URI in a glTF names.

    Raises:
        InputError: if it does not lie in the folder of the glTF, or is a pipe or a device.
    """
    name = name_in_folder(uri)
    if name is None:
        raise InputError(f"{path} refers to {uri[:80]!r}, which does not lie in its folder.")
    # In a URI %20 is a space; some exporters mean the digits. From a folder "a%2fb", ".." would lead out.
    plain = path.parent / uri
    literal = "%" in uri and ".." not in Path(uri).parts and plain.is_file()
    file = plain if literal else path.parent / name
    if file.exists() and not file.is_file():
        raise InputError(f"{path} refers to {uri[:80]!r}, which is not a file.")
    return file


def _check_header(path: Path, data: bytes) -> None:
    """Refuse an OFF or PLY file that declares more elements than it has bytes."""
    head = data[:HEADER]
    if path.suffix.lower() == ".off":
        found = re.search(rb"OFF\s+(\d+)\s+(\d+)", re.sub(rb"#[^\r\n]*", b"", head))
        counts = list(found.groups()) if found else []
    else:
        counts = re.findall(rb"^element\s+\S+\s+(\d+)", head.partition(b"end_header")[0], re.MULTILINE)
    most = max((int(count) for count in counts), default=0)
    if most > len(data):
        raise InputError(f"{path} declares {most} vertices or faces, more than it has bytes.")


def _check_views(path: Path, tree: dict[str, Any], held: int) -> None:
    """Refuse views of buffers that repeat their bytes: each is copied, and each element of a short stride."""
    views = tree.get("bufferViews", [])
    if sum(view["byteLength"] for view in views) > max(FREE_NUMBERS, REPEATED * held):
        raise InputError(f"{path} refers to the same bytes again and again; export it again.")
    for index, entry in enumerate(tree.get("accessors", [])):
        if "bufferView" not in entry or "byteStride" not in (view := views[entry["bufferView"]]):
            continue
        size = WIDTHS[entry["type"]] * np.dtype(COMPONENTS[entry["componentType"]]).itemsize
        if view["byteStride"] < size:
            raise InputError(
                f"{path} has elements of {size} bytes {view['byteStride']} bytes apart, in accessor {index}; "
                "export it again."
            )


def _check_counts(path: Path, tree: dict[str, Any], held: int) -> None:
    """Refuse counts that the file cannot hold, and parts repeated until they fill the memory."""
    accessors, nodes = tree.get("accessors", []), tree.get("nodes", [])
    numbers = [entry["count"] * WIDTHS[entry["type"]] for entry in accessors]
    unbacked = sum(n for n, entry in zip(numbers, accessors, strict=True) if "bufferView" not in entry)
    if sum(numbers) > max(FREE_NUMBERS, REPEATED * held) or unbacked > FREE_NUMBERS:
        many = min(sum(numbers), 10**15)  # a number may have a thousand digits
        raise InputError(f"{path} declares {many} numbers, more than a mesh file can hold.")
    placed = Counter(node["mesh"] for node in nodes if "mesh" in node)
    parts, vertices = 0, 0
    for index, mesh in enumerate(tree.get("meshes", [])):
        for part in mesh["primitives"]:
            used = [part["attributes"].get("POSITION"), part.get("indices")]
            largest = max((accessors[i]["count"] for i in used if i is not None), default=0)
            parts += max(placed[index], 1)
            vertices += largest * max(placed[index], 1)
    if max(parts, len(nodes)) > MOST_PARTS:
        raise InputError(f"{path} places {max(parts, len(nodes))} parts; join them to {MOST_PARTS} or fewer.")
    if vertices > (most := max(FREE_VERTICES, held)):
        raise InputError(f"{path} places {vertices} vertices; reduce it to {most} or fewer.")
