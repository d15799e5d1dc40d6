"""Limits of mesh files: what a header says, held against what it can hold, before a parser believes it."""

import json
import os
import re
import struct
from collections import Counter
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from normalgan.errors import InputError
from normalgan.limits import MOST_BYTES, read_bounded

HEADER = 2**16
"""Bytes of a file in which it has to say what it holds."""
MOST_NUMBERS = 2**28
"""More numbers than this in the accessors of a glTF are refused: `MOST_BYTES` of floats."""
MOST_UNBACKED = 2**24
"""More numbers than this without a byte behind them are refused: glTF takes them for zeros."""
MOST_VERTICES = 2**26
"""More vertices than this in a scene are refused, those of a repeated part counted each time."""
MOST_PARTS = 5_000
"""More nodes, or more placed parts of meshes, are refused: each takes trimesh a millisecond and more."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def check_limits(path: Path) -> None:
    """Look at a mesh file before it is parsed.

    Args:
        path: of one of the formats of `SUFFIXES`; a file that is there.

    Raises:
        InputError: if it is too large, announces more than it can hold, or refers to something outside its
            folder.
        ValueError, LookupError, TypeError, AttributeError, struct.error: if it is not of its format.
    """
    if path.stat().st_size > MOST_BYTES:
        read_bounded(path)  # refuses
    match path.suffix.lower():
        case ".off" | ".ply":
            _check_header(path)
        case ".glb" | ".gltf":
            try:
                tree = gltf_tree(path)
            except RecursionError:
                raise InputError(f"{path} is nested more deeply than any mesh file.") from None
            _check_buffers(path, tree)
            _check_counts(path, tree)


def gltf_tree(path: Path) -> dict[str, Any]:
    """Return the JSON of a glTF file (glTF 2.0, sections 3 and 4.4).

    Raises:
        InputError: if it is too large.
        ValueError, struct.error, RecursionError: if it is none.
    """
    data = read_bounded(path)
    if path.suffix.lower() == ".glb":
        data = data[20 : 20 + struct.unpack_from("<I", data, 12)[0]]
    tree = json.loads(data)
    if not isinstance(tree, dict):
        raise ValueError("its JSON is no object")
    return tree


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


def _check_header(path: Path) -> None:
    """Refuse an OFF or PLY file that announces more elements than it has bytes."""
    with path.open("rb") as file:
        head = file.read(HEADER)
    if path.suffix.lower() == ".off":
        found = re.search(rb"OFF\s+(\d+)\s+(\d+)", re.sub(rb"#[^\r\n]*", b"", head))
        counts = list(found.groups()) if found else []
    else:
        counts = re.findall(rb"^element\s+\S+\s+(\d+)", head.partition(b"end_header")[0], re.MULTILINE)
    most = max((int(count) for count in counts), default=0)
    if most > path.stat().st_size:
        raise InputError(f"{path} announces {most} vertices or faces, more than it has bytes.")


def _check_buffers(path: Path, tree: dict[str, Any]) -> None:
    for buffer in tree.get("buffers", []):
        uri = buffer.get("uri", "")
        if not uri or uri.startswith("data:"):
            continue
        name = name_in_folder(uri)
        if name is None:
            raise InputError(f"{path} refers to {uri[:80]!r}, which does not lie in its folder.")
        if (path.parent / name).exists() and not (path.parent / name).is_file():
            raise InputError(f"{path} refers to {uri[:80]!r}, which is no file.")
        if (path.parent / name).is_file() and (path.parent / name).stat().st_size > MOST_BYTES:
            read_bounded(path.parent / name)  # refuses


def _check_counts(path: Path, tree: dict[str, Any]) -> None:
    """Refuse numbers that nothing holds, and parts repeated until they fill the memory."""
    accessors, nodes = tree.get("accessors", []), tree.get("nodes", [])
    numbers = [entry["count"] * WIDTHS[entry["type"]] for entry in accessors]
    unbacked = sum(n for n, entry in zip(numbers, accessors, strict=True) if "bufferView" not in entry)
    if sum(numbers) > MOST_NUMBERS or unbacked > MOST_UNBACKED:
        raise InputError(f"{path} announces {sum(numbers)} numbers, more than a mesh file can hold.")
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
    if vertices > MOST_VERTICES:
        raise InputError(f"{path} places {vertices} vertices; reduce it to {MOST_VERTICES} or fewer.")
