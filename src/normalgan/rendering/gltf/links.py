"""Links of a glTF file: the buffers that it names, which must lie in its folder or below."""

import os
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from normalgan.errors import InputError

__all__ = ["buffer_file", "linked_buffers"]


def _name_in_folder(uri: str) -> str | None:
    """Return the path that a URI names relative to its file's folder; None if it leads out of it.

    >>> _name_in_folder("a%20b.bin"), _name_in_folder("%2e%2e/b.bin"), _name_in_folder("file:///etc/hostname")
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
    name = _name_in_folder(uri)
    if name is None:
        raise InputError(f"{path} refers to {uri[:80]!r}, which does not lie in its folder.")
    # A URI writes a space as %20; some exporters do not.
    plain = path.parent / uri
    file = plain if "%" in uri and plain.is_file() else path.parent / name
    if file.exists() and not file.is_file():
        raise InputError(f"{path} refers to {uri[:80]!r}, which is no file.")
    return file
