"""The container of glTF: its JSON and its buffers, from a .glb, or a .gltf with its files."""

import base64
import binascii
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.rendering.gltf.file import read_gltf
from normalgan.rendering.mesh_bytes import mesh_bytes
from normalgan.rendering.mesh_limits import buffer_file

__all__ = ["RIG_SUFFIXES", "Container", "bad_gltf", "has_skin", "read_container", "refusing_bad_gltf"]

RIG_SUFFIXES = (".glb", ".gltf")
"""The file formats that can hold a skin."""

_KNOWN = ("KHR_mesh_quantization", "KHR_animation_pointer", "KHR_node_visibility")
_LOOKS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_xmp", "EXT_texture_", "EXT_lights_", "MSFT_")
"""Required extensions that are read, and beginnings of those that alter no surface; others are refused."""


@dataclass(frozen=True)
class Container:
    """The raw content of a glTF 2.0 file (Khronos Group, glTF 2.0 Specification, 2021).

    Args:
        path: the file.
        tree: its JSON.
        buffers: the bytes of its buffers, each at least as long as declared.
    """

    path: Path
    tree: dict[str, Any]
    buffers: tuple[bytes, ...]

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """Return entry number ``index`` of a list of the JSON, such as ``accessors``.

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
    """Return the error for a file that cannot be used."""
    return InputError(f"{path} cannot be read as a mesh: {reason}.")


@contextmanager
def refusing_bad_gltf(path: Path) -> Iterator[None]:
    """Refuse a file that violates glTF in a way without a specific message."""
    try:
        yield
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise bad_gltf(path, "it is not as glTF 2.0 says") from error


def has_skin(path: Path) -> bool:
    """Return whether a file is glTF with a skin; False for a broken one."""
    if path.suffix.lower() not in RIG_SUFFIXES:
        return False
    try:
        return bool(_tree(path)[0].get("skins"))
    except InputError:
        return False  # loading it as a mesh raises the error


def read_container(path: Path) -> Container:
    """Return the JSON and the buffers of a glTF file.

    Raises:
        InputError: if it cannot be read, is not glTF 2.0, needs an extension that is not supported, or lacks
            a buffer.
    """
    tree, binary = _tree(path)
    for name in map(str, tree.get("extensionsRequired", [])):
        if name not in _KNOWN and not name.startswith(_LOOKS):
            raise bad_gltf(path, f"it needs the extension {name[:60]}, which is not read; export it without")
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
    """Return the JSON of a file and the binary chunk of a .glb."""
    try:
        tree, binary = read_gltf(path)
        version = str(tree["asset"]["version"])
    except InputError:
        raise
    except (ValueError, LookupError, TypeError, struct.error, RecursionError) as error:
        raise bad_gltf(path, f"it is not a glTF file: {brief(error)}") from error
    if not version.startswith("2"):
        raise bad_gltf(path, f"it is glTF {version}; export it as 2.0")
    return tree, binary


def _linked(path: Path, uri: str) -> bytes:
    """Return the bytes of a URI: embedded, or in a file next to or below the glTF file."""
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error as error:
            raise bad_gltf(path, f"a buffer written into it is not base64: {brief(error)}") from error
    file = buffer_file(path, uri)
    if not file.is_file():
        raise bad_gltf(path, f"its buffer {uri!r} is missing")
    return mesh_bytes(file)
