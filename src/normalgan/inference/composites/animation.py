"""Animation: GIF, WebP and PNG that move: told from still ones, and written."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.errors import InputError
from normalgan.files.limits import read_bounded
from normalgan.inference.reading.drawings import MOST_BYTES

__all__ = ["SUFFIXES", "Kind", "encode_animation", "kind_of", "moving_kind"]

Kind = Literal["gif", "webp", "png"]
"""Of an animation; a PNG that moves is an APNG."""
SUFFIXES = (".gif", ".webp", ".png", ".apng", ".ase", ".aseprite")
_MOST_CHUNKS = 1000
_EXTENSION, _IMAGE, _END = 0x21, 0x2C, 0x3B


def moving_kind(path: Path, content: bytes | None = None) -> Kind | None:
    """Return the kind of an animation; None of a still picture, and of what cannot be read.

    Only the marks between the pictures are looked at; nothing is decoded.

    Args:
        path: its file, or what to call it.
        content: what is in it, if it was read already.

    Raises:
        InputError: if it is a GIF that ends within a frame, whose rest a decoder would leave out silently.
    """
    if content is None and (path.suffix.lower() not in SUFFIXES or not path.is_file()):
        return None
    try:
        with io.BytesIO(content) if content is not None else path.open("rb") as file:
            start = file.read(32)
            if start.startswith(b"\x89PNG"):
                return "png" if _is_apng(file) else None
        if start[4:6] == b"\xe0\xa5":  # Aseprite: what it shows goes into a PNG that moves
            return "png" if int.from_bytes(start[6:8], "little") > 1 else None
        if start[:4] == b"RIFF" and start[8:16] == b"WEBPVP8X":
            return "webp" if start[20:21] and start[20] & 2 else None
        if not start.startswith(b"GIF8"):
            return None
        return "gif" if _frames_of_gif(path, content or read_bounded(path, MOST_BYTES)) > 1 else None
    except OSError:
        return None  # who reads the drawing tells why


def kind_of(path: Path) -> Kind:
    """Return the kind of an animation by its file's name."""
    match path.suffix.lower():
        case ".gif":
            return "gif"
        case ".webp":
            return "webp"
        case _:
            return "png"


def _is_apng(file: BinaryIO) -> bool:
    """Return whether a PNG has several frames: it says so before its pixels."""
    file.seek(8)
    for _ in range(_MOST_CHUNKS):
        head = file.read(8)
        if len(head) < 8 or head[4:] == b"IDAT":
            return False
        if head[4:] == b"acTL":
            return int.from_bytes(file.read(4), "big") > 1
        file.seek(int.from_bytes(head[:4], "big") + 4, io.SEEK_CUR)
    return False


def _frames_of_gif(path: Path, data: bytes) -> int:
    """Return how many frames a GIF has."""
    count = 0
    try:
        at = 13 + _table(data[10])
        while at < len(data) and data[at] != _END:
            if data[at] == _EXTENSION:
                at = _after_blocks(data, at + 2)
            elif data[at] == _IMAGE:
                at = _after_blocks(data, at + 11 + _table(data[at + 9]))
                count += 1
            else:
                return count  # what follows is no GIF any more; browsers show what was before
    except IndexError:
        raise InputError(f"{path} is broken: it ends within its frame {count + 1}.") from None
    return count


def _table(flags: int) -> int:
    """Return the bytes of a table of colours."""
    return 3 * 2 ** ((flags & 7) + 1) if flags & 0x80 else 0


def _after_blocks(data: bytes, at: int) -> int:
    """Return where the blocks end that begin at ``at``."""
    while data[at]:
        at += data[at] + 1
        if at >= len(data):
            raise IndexError
    return at + 1


def encode_animation(
    kind: Kind, frames: Sequence[NDArray[np.uint8]], durations: Sequence[int], loop: int
) -> bytes:
    """Return frames (H, W, 3) or (H, W, 4) as a file; WebP and PNG keep every colour, a GIF 256 a frame.

    Args:
        kind: of the file.
        frames: one at least.
        durations: milliseconds that each is shown.
        loop: how often all are shown; 0 is for ever.
    """
    first, *rest = (Image.fromarray(each) for each in frames)
    file = io.BytesIO()
    match kind:
        case "gif":
            # What a frame leaves transparent must not show the one before.
            shown = 2 if frames[0].shape[2] == 4 else 1
            once = {} if loop == 1 else {"loop": loop}
            first.save(
                file,
                "GIF",
                save_all=True,
                append_images=rest,
                duration=list(durations),
                disposal=shown,
                **once,
            )
        case "webp":
            first.save(
                file,
                "WEBP",
                save_all=True,
                append_images=rest,
                duration=list(durations),
                loop=loop,
                lossless=True,
                exact=True,
                quality=50,
            )
        case "png":
            first.save(
                file, "PNG", save_all=True, append_images=rest, duration=list(durations), loop=loop, blend=0
            )
    return file.getvalue()
