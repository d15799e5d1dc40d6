"""The main program of the child process that decodes pictures; see `normalgan.decoding`.

It answers requests over a `multiprocessing.connection`. Each message is JSON or pixels, never a pickle.
"""

import codecs
import encodings
import json
import pkgutil
import signal
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from typing import Any

from .formats import format_of
from .levels import exact_levels, loses_levels
from .limits import limit, limit_time
from .opening import Message, RefusedError, import_plugin, with_form
from .pictures import decode, frames, layers, noted, tileset

__all__ = ["import_all", "main", "needed"]

_STRIP = 2**20
"""Number of pixels sent at a time."""


def main(handle: int, needs: str, seconds: int, memory: int, folders: list[str]) -> None:
    """Answer requests until the parent closes the connection.

    Args:
        handle: handle of the connection.
        needs: libraries for the pictures, as returned by `needed`.
        seconds: limit of processor time per picture, in seconds.
        memory: limit of address space in bytes, in addition to that of the libraries.
        folders: folders of the installed libraries.
    """
    from multiprocessing import connection as connections

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is handled by the parent
    if sys.platform == "win32":
        connection = connections.PipeConnection(handle)
    else:
        connection = connections.Connection(handle)
    sys.path.extend(folders)
    try:
        import_all(needs)
        limit(memory)
    except Exception as error:
        _send(connection, _refusal(f"{type(error).__name__}: {error}"), None)
        return
    _send(connection, {"ready": True}, None)
    while True:
        try:
            request, content = json.loads(connection.recv_bytes()), connection.recv_bytes()
        except (EOFError, OSError):
            return
        limit_time(seconds)
        try:
            for header, pixels in _answers(request, content, seconds):
                _send(connection, header, pixels)
                del pixels
        except RefusedError as refusal:
            _send(connection, _refusal(str(refusal)), None)
        except MemoryError:
            words = f"needs more than {memory >> 20} MiB of memory to be decoded"
            _send(connection, _refusal(words), None)
        del content


def needed(content: bytes, exact: bool = False) -> str:
    """Return the additional library that a picture needs, or "" if none."""
    found = format_of(content[:64])
    name = found.name if found is not None else ""
    if name in {"PSD", "HEIC"}:
        return {"PSD": "psd_tools", "HEIC": "pillow_heif"}[name]
    return "cv2" if name == "TIFF" or (exact and loses_levels(content)) else ""


def import_all(needs: str) -> None:
    """Import everything needed for decoding, because no file can be opened under the limits."""
    modules = [
        "resvg_py",
        "xml.etree.ElementTree",
        "PIL.ImageChops",
        "PIL.ImageOps",
        "numpy",
    ]
    modules += [f"PIL.{plugin}ImagePlugin" for plugin in ("Avif", "Mpo", "Tiff", "WebP")]
    if needs == "psd_tools":
        modules += ["psd_tools.composite", "PIL.ImageCms"]
        modules += [f"scipy.{part}" for part in ("interpolate", "ndimage", "spatial")]
    elif needs == "cv2":
        modules += ["cv2"]
    for module in modules:
        import_module(module)
    import_module(".layered_files", __package__)
    from PIL import Image

    Image.preinit()  # otherwise imported for the first picture
    if needs == "pillow_heif":
        with suppress(ImportError):  # `opened` reports that it is not installed
            import_plugin("HEIF")
    for found in pkgutil.iter_modules(encodings.__path__):  # codecs of SVG and of names in ZIP files
        if found.name.startswith(("cp", "iso8859", "koi8", "mac_", "utf_")):
            codecs.lookup(found.name)


def _answers(request: dict[str, Any], content: bytes, seconds: int) -> Iterator[Message]:
    """Yield the description of a file with the number of pictures, and then each picture."""
    least, most = request["sides"]
    match request["what"]:
        case "frames":
            yield from frames(content, least, most, seconds)
        case "layers":
            yield from layers(content, least, most, seconds)
        case "tileset":
            yield from tileset(content, least, most)
        case _:
            yield from _picture(request, content, least, most)


def _picture(request: dict[str, Any], content: bytes, least: int, most: int) -> Iterator[Message]:
    notes: list[Any] = []
    if request["exact"] and loses_levels(content):
        pixels = exact_levels(content, least, most)
        height, width = pixels.shape[:2]
    else:
        sizes = request["svg_side"], request["longest"]
        pixels, (width, height) = decode(content, least, most, *sizes, request["grey"], notes)
    yield {"count": 1, **noted(*notes)}, None
    yield {**with_form(pixels), "full": [height, width]}, pixels


def _send(connection: Any, header: dict[str, Any], pixels: Any) -> None:
    connection.send_bytes(json.dumps(header).encode())
    if pixels is None:
        return
    height, width = header["shape"][:2]
    rows = max(_STRIP // width, 1)  # in strips, because a copy of a large picture would double the memory
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        strip = pixels[top:bottom] if hasattr(pixels, "dtype") else pixels.crop((0, top, width, bottom))
        connection.send_bytes(strip.tobytes())


def _refusal(words: str) -> dict[str, str]:
    return {"refused": " ".join(words.split())[:600]}
