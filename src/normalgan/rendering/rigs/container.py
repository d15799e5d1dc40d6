"""The glTF container: its JSON and its buffers, out of a .glb or out of a .gltf with files beside it."""

import base64
import binascii
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.rendering.gltf import read_gltf
from normalgan.rendering.mesh_bytes import mesh_bytes
from normalgan.rendering.mesh_limits import name_in_folder

__all__ = ["PACKED", "RIG_SUFFIXES", "Container", "bad_rig", "has_skin", "read_container"]

RIG_SUFFIXES = (".glb", ".gltf")
"""The file formats that can hold a skin."""

PACKED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
"""Extensions that keep the numbers where only their own decoders find them."""


@dataclass(frozen=True)
class Container:
    """The raw content of a glTF 2.0 file (Khronos Group, glTF 2.0 Specification, 2021).

    Args:
        path: the file.
        tree: its JSON.
        buffers: the bytes of its buffers, each as long as it says or longer.
    """

    path: Path
    tree: dict[str, Any]
    buffers: tuple[bytes, ...]

    def item(self, kind: str, index: Any) -> dict[str, Any]:
        """Return entry number ``index`` of a list of the JSON, such as ``accessors``.

        Raises:
            InputError: if there is none of that number.
        """
        items = self.tree.get(kind, [])
        # Not items[index]: Python would take -1 for the last.
        if type(index) is not int or not 0 <= index < len(items):
            raise bad_rig(self.path, f"it refers to entry {index} of its {len(items)} {kind}")
        entry = items[index]
        if not isinstance(entry, dict):
            raise bad_rig(self.path, f"entry {index} of its {kind} is no object")
        return entry


def bad_rig(path: Path, reason: str) -> InputError:
    """Return the error for a rig that cannot be used."""
    return InputError(f"the rig in {path} cannot be used: {reason}.")


def has_skin(path: Path) -> bool:
    """Return whether a file is glTF with a skin; False for a broken one."""
    if path.suffix.lower() not in RIG_SUFFIXES:
        return False
    try:
        return bool(_tree(path)[0].get("skins"))
    except InputError:
        return False  # whoever loads it as a mesh says how it is broken


def read_container(path: Path) -> Container:
    """Return the JSON and the buffers of a glTF file.

    Raises:
        InputError: if it cannot be read, is no glTF 2.0, is compressed, or lacks a buffer.
    """
    tree, binary = _tree(path)
    required = tree.get("extensionsRequired", [])
    if packed := [name for name in PACKED if name in required]:
        raise bad_rig(path, f"it is compressed by {packed[0]}; export it without")
    buffers = []
    for index, entry in enumerate(tree.get("buffers", [])):
        uri = entry.get("uri")
        content = _linked(path, uri) if uri is not None else binary if index == 0 else None
        if content is None:
            raise bad_rig(path, f"its buffer {index} is missing")
        if len(content) < entry["byteLength"]:
            raise bad_rig(
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
        raise bad_rig(path, f"it is no glTF file: {brief(error)}") from error
    if not version.startswith("2"):
        raise bad_rig(path, f"it is glTF {version}; export it as 2.0")
    return tree, binary


def _linked(path: Path, uri: str) -> bytes:
    """Return the bytes that a URI stands for: in itself, or in a file beside or below the glTF file."""
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error as error:
            raise bad_rig(path, f"a buffer written into it is no base64: {brief(error)}") from error
    name = name_in_folder(uri)
    if name is None:
        raise bad_rig(path, f"its buffer {uri!r} does not lie in its folder")
    if not (path.parent / name).is_file():
        raise bad_rig(path, f"its buffer {uri!r} is missing")
    return mesh_bytes(path.parent / name)
