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
from contextlib import nullcontext, suppress
from importlib import import_module
from typing import Any

from .formats import FORMATS, detect_format
from .levels import exact_levels, loses_levels
from .limits import limit, limit_time
from .opening import Message, RefusedError, with_form
from .pictures import decode, frames, layers, noted, tileset

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

    for name in ("SIGINT", "SIGUSR1"):  # the parent handles Ctrl-C, and SLURM's warning
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
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
    found = detect_format(content[:64])
    if found is not None and found.library:
        return found.library
    return "cv2" if exact and loses_levels(content) else ""


def import_all(library: str) -> None:
    """Import everything that decoding needs, because no file can be opened under the limits.

    Args:
        library: the additional library that `needed` names; empty for none.
    """
    modules = ["PIL.ImageChops", "PIL.ImageOps", "numpy", *([library] if library else [])]
    modules += [name for each in FORMATS if each.library in {"", library} for name in each.modules]
    for module in modules:
        # If pillow_heif is not installed, `opened` says so for each picture.
        with suppress(ImportError) if module == "pillow_heif" else nullcontext():
            import_module(module)
    import_module(".layered_files", __package__)
    from PIL import Image

    Image.preinit()  # what it would import for the first picture
    for found in pkgutil.iter_modules(encodings.__path__):  # those of SVG and of names in ZIP
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
