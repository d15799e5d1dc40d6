"""The container of glTF 2.0: JSON and buffers, from a .glb, or a .gltf with its files."""

import base64
import binascii
import json
import os
import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import numpy as np

from normalgan.errors import InputError, brief
from normalgan.rendering.mesh_bytes import mesh_bytes

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""NumPy dtypes of the component types of accessors."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Number of components per element for each accessor type."""

_FREE_NUMBERS = 2**22
"""Maximum count of numbers declared by accessors regardless of the file's size; more need bytes in the
file."""
_FREE_VERTICES = 2**18
"""Maximum number of placed vertices regardless of file size, counting repeated parts each time."""
_MOST_PARTS = 5_000
"""Maximum number of nodes, or of placed parts of meshes, because each takes at least a millisecond."""
_MOST_REUSES = 4
"""Maximum number of times that accessors use the bytes of a file; nearly all exporters use them once."""

SUFFIXES = (".glb", ".gltf")
"""File extensions of glTF, in lower case."""
_SUPPORTED = ("KHR_mesh_quantization", "KHR_animation_pointer", "KHR_node_visibility")
_LOOKS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_xmp", "EXT_texture_", "EXT_lights_", "MSFT_")
"""Supported required extensions, and prefixes of those that do not affect surfaces; others are refused."""
_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


@dataclass(frozen=True)
class Container:
    """The raw content of a glTF 2.0 file (Khronos Group, glTF 2.0 Specification, 2021).

    Args:
        path: path of the file.
        tree: the file's JSON.
        buffers: bytes of the buffers, each at least as long as declared.
    """

    path: Path
    tree: dict[str, Any]
    buffers: tuple[bytes, ...]

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """Return the entry at an index of one of the JSON's lists, such as ``accessors``.

        Raises:
            InputError: if there is no such entry.
        """
        items = self.tree.get(kind, [])
        # Not items[index], because Python takes -1 for the last.
        if type(index) is not int or not 0 <= index < len(items):
            raise bad_gltf(self.path, f"it refers to entry {index} of its {len(items)} {kind}")
        entry = items[index]
        if not isinstance(entry, dict):
            raise bad_gltf(self.path, f"entry {index} of its {kind} is not an object")
        return entry


def bad_gltf(path: Path, reason: str) -> InputError:
    """Return the error for an unusable file."""
    return InputError(f"{path} cannot be read as a mesh: {reason}.")


@contextmanager
def refusing_bad_gltf(path: Path) -> Iterator[None]:
    """Convert exceptions from malformed glTF data to an `InputError`."""
    try:
        yield
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise bad_gltf(path, "it does not conform to glTF 2.0") from error


def has_skin(path: Path) -> bool:
    """Return whether a file is glTF with a skin; False for a damaged file."""
    if path.suffix.lower() not in SUFFIXES:
        return False
    try:
        return bool(_tree(path)[0].get("skins"))
    except InputError:
        return False  # loading it as a mesh raises the error


def read_container(path: Path) -> Container:
    """Return the JSON and the buffers of a glTF file, after checking its declared sizes.

    Raises:
        InputError: if the file cannot be read, is not glTF 2.0, needs an unsupported extension, lacks a
            buffer, or would exhaust memory.
        LookupError, TypeError, ValueError, AttributeError: if the file is inconsistent; see
            `refusing_bad_gltf`.
    """
    tree, binary = _tree(path)
    for name in map(str, tree.get("extensionsRequired", [])):
        if name not in _SUPPORTED and not name.startswith(_LOOKS):
            raise bad_gltf(
                path,
                f"it needs the extension {name[:60]}, which is not supported; export the file without it",
            )
    held = len(mesh_bytes(path)) + sum(len(mesh_bytes(buffer)) for buffer in linked_buffers(path))
    _check_views(path, tree, held)
    _check_counts(path, tree, held)
    buffers = []
    for index, entry in enumerate(tree.get("buffers", [])):
        uri = entry.get("uri")
        content = _linked(path, uri) if uri is not None else binary if index == 0 else None
        if content is None:
            raise bad_gltf(path, f"its buffer {index} is missing")
        if len(content) < entry["byteLength"]:
            raise bad_gltf(
                path,
                f"its buffer {index} has {len(content)} bytes of {entry['byteLength']}; is it truncated?",
            )
        buffers.append(content)
    return Container(path, tree, tuple(buffers))


def _tree(path: Path) -> tuple[dict[str, Any], bytes | None]:
    """Return the JSON of a .gltf or .glb, and the binary chunk of a .glb if there is one."""
    data, binary = mesh_bytes(path), None
    try:
        if path.suffix.lower() == ".glb":
            chunks = _chunks(data)
            data, binary = chunks[_JSON], chunks.get(_BINARY)
        tree = json.loads(data)
        version = str(tree["asset"]["version"])
    except RecursionError as error:
        raise bad_gltf(path, "it is nested more deeply than any real mesh file") from error
    except (ValueError, LookupError, TypeError, struct.error) as error:
        raise bad_gltf(path, f"it is not a glTF file: {brief(error)}") from error
    if not version.startswith("2"):
        raise bad_gltf(path, f"it is glTF {version}; export it as 2.0")
    return tree, binary


def _linked(path: Path, uri: str) -> bytes:
    """Return the bytes of a URI, which are embedded or in a file in the folder of the glTF file or below."""
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error as error:
            raise bad_gltf(path, f"a buffer written into it is not base64: {brief(error)}") from error
    file = _buffer_file(path, uri)
    if not file.is_file():
        raise bad_gltf(path, f"its buffer {uri!r} is missing")
    return mesh_bytes(file)


def linked_buffers(path: Path) -> list[Path]:
    """Return the existing buffer files of a .gltf; none for other or damaged files, which `load` refuses.

    Raises:
        InputError: if a buffer file is not in the folder of the .gltf, or is a pipe or a device.
    """
    if path.suffix.lower() != ".gltf":
        return []
    try:
        uris = [buffer.get("uri", "") for buffer in json.loads(mesh_bytes(path)).get("buffers", [])]
        found = [_buffer_file(path, uri) for uri in uris if uri and not uri.startswith("data:")]
    except (ValueError, LookupError, AttributeError, TypeError, RecursionError, OSError):
        return []
    return [file for file in found if file.is_file()]


def _buffer_file(path: Path, uri: str) -> Path:
    """Return the file that a URI in a glTF refers to.

    Raises:
        InputError: if the file is not in the folder of the glTF, or is a pipe or a device.
    """
    name = _name_in_folder(uri)
    if name is None:
        raise InputError(f"{path} refers to {uri[:80]!r}, which is not in its folder.")
    # %20 in a URI is a space, but some exporters mean it literally. From a folder "a%2fb", ".." would lead
    # out.
    plain = path.parent / uri
    literal = "%" in uri and ".." not in Path(uri).parts and plain.is_file()
    file = plain if literal else path.parent / name
    if file.exists() and not file.is_file():
        raise InputError(f"{path} refers to {uri[:80]!r}, which is not a file.")
    return file


def _name_in_folder(uri: str) -> str | None:
    """Return the path of a URI relative to its file's folder, or None if it leads out of the folder.

    >>> _name_in_folder("a%20b.bin"), _name_in_folder("%2e%2e/b.bin"), _name_in_folder("file:///etc/hostname")
    ('a b.bin', None, None)
    """
    try:
        parts = urlsplit(uri)
    except ValueError:  # an incomplete IPv6 address
        return None
    name = Path(os.path.normpath(unquote(parts.path)))
    outside = parts.scheme or parts.netloc or name.is_absolute() or name.parts[:1] == ("..",)
    return None if outside or "\0" in str(name) else str(name)


def _chunks(data: bytes) -> dict[int, bytes]:
    """Return the chunks of a .glb by type."""
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


def _check_views(path: Path, tree: dict[str, Any], held: int) -> None:
    """Refuse buffer views that reuse bytes too often or have overlapping elements, because all are copied."""
    views = tree.get("bufferViews", [])
    if sum(view["byteLength"] for view in views) > max(_FREE_NUMBERS, _MOST_REUSES * held):
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
    """Refuse counts that the file cannot hold, and repeated parts that would exhaust memory."""
    accessors, nodes = tree.get("accessors", []), tree.get("nodes", [])
    numbers = [entry["count"] * WIDTHS[entry["type"]] for entry in accessors]
    unbacked = sum(n for n, entry in zip(numbers, accessors, strict=True) if "bufferView" not in entry)
    if sum(numbers) > max(_FREE_NUMBERS, _MOST_REUSES * held) or unbacked > _FREE_NUMBERS:
        many = min(sum(numbers), 10**15)  # the number may have a thousand digits
        raise InputError(f"{path} declares {many} numbers, more than a mesh file can hold.")
    placed = Counter(node["mesh"] for node in nodes if "mesh" in node)
    parts, vertices = 0, 0
    for index, mesh in enumerate(tree.get("meshes", [])):
        for part in mesh["primitives"]:
            used = [part["attributes"].get("POSITION"), part.get("indices")]
            largest = max((accessors[i]["count"] for i in used if i is not None), default=0)
            parts += max(placed[index], 1)
            vertices += largest * max(placed[index], 1)
    if max(parts, len(nodes)) > _MOST_PARTS:
        raise InputError(
            f"{path} places {max(parts, len(nodes))} parts; join them to {_MOST_PARTS} or fewer."
        )
    if vertices > (most := max(_FREE_VERTICES, held)):
        raise InputError(f"{path} places {vertices} vertices; reduce it to {most} or fewer.")
