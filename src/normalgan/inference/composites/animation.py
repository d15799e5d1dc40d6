"""Animation: recognise and write animated GIF, WebP and PNG."""

import io
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.decoding.decoders.formats import MOVING, NO_PAGE, SUBFILE
from normalgan.errors import InputError
from normalgan.files.limits import read_bounded
from normalgan.inference.reading.drawings import MOST_BYTES

Kind = Literal["gif", "webp", "png"]
"""Formats of animations; APNG has the ending .png too."""
PAGES: Literal["pages"] = "pages"
"""Returned instead of an animation's kind for a file with several pages, which are not a sequence in time."""
KINDS: dict[str, Kind] = {".gif": "gif", ".webp": "webp"}
"""The kinds of animations by file extension; any other is an APNG."""
_MOST_CHUNKS = 1000
_EXTENSION, _CONTROL, _IMAGE, _END = 0x21, 0xF9, 0x2C, 0x3B


def moving_kind(path: Path, content: bytes | None = None) -> Kind | Literal["pages"] | None:
    """Return the kind of an animation, `PAGES` for a multi-page file, or None for a single picture.

    Only the headers of blocks and chunks are parsed; nothing is decoded.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.

    Raises:
        InputError: if the file is a GIF that ends within a frame, which a decoder would truncate silently.
    """
    if content is None and (path.suffix.lower() not in MOVING or not path.is_file()):
        return None
    try:
        with io.BytesIO(content) if content is not None else path.open("rb") as file:
            start = file.read(32)
            if start.startswith(b"\x89PNG"):
                return "png" if _frames_of_apng(file) > 1 else None
            if start.startswith((b"II", b"MM")):
                return PAGES if _pages_of_tiff(file) > 1 else None
        if start[4:6] == b"\xe0\xa5":  # Aseprite: its frames are written as an animated PNG
            return "png" if int.from_bytes(start[6:8], "little") > 1 else None
        if start[4:12] == b"ftypavis":  # AVIF
            return "png"
        if start[:4] == b"RIFF" and start[8:16] == b"WEBPVP8X":
            return "webp" if start[20:21] and start[20] & 2 else None
        if not start.startswith(b"GIF8"):
            return None
        return "gif" if _frames_of_gif(path, content or read_bounded(path, MOST_BYTES)) > 1 else None
    except OSError:
        return None  # the error is raised when the drawing is read


def count_parts(content: bytes) -> int:
    """Return the number of pages or frames of a file; 1 for AVIF, whose header does not record it.

    Raises:
        InputError: as `moving_kind` does.
    """
    file = io.BytesIO(content)
    match moving_kind(Path("the file"), content):
        case "pages":
            return _pages_of_tiff(file)
        case "gif":
            return _frames_of_gif(Path("the file"), content)
        case "webp":
            return _frames_of_webp(file)
        case "png" if content.startswith(b"\x89PNG"):
            return _frames_of_apng(file)
        case "png" if content[4:6] == b"\xe0\xa5":
            return int.from_bytes(content[6:8], "little")
    return 1


def _frames_of_apng(file: BinaryIO) -> int:
    """Return the number of frames of a PNG, which is stored before the pixels."""
    file.seek(8)
    for _ in range(_MOST_CHUNKS):
        head = file.read(8)
        if len(head) < 8 or head[4:] == b"IDAT":
            return 1
        if head[4:] == b"acTL":
            return int.from_bytes(file.read(4), "big")
        file.seek(int.from_bytes(head[:4], "big") + 4, io.SEEK_CUR)
    return 1


def _frames_of_webp(file: BinaryIO) -> int:
    """Return the number of frames of a WebP by counting its frame chunks."""
    file.seek(12)
    count = 0
    while len(head := file.read(8)) == 8:
        count += head[:4] == b"ANMF"
        length = int.from_bytes(head[4:], "little")
        file.seek(length + length % 2, io.SEEK_CUR)
    return count


def _pages_of_tiff(file: BinaryIO) -> int:
    """Return the number of pages of a TIFF, without thumbnails and masks (TIFF 6.0, sections 2 and 8)."""
    file.seek(0)
    head = file.read(16)
    order: Literal["little", "big"] = "little" if head[:2] == b"II" else "big"
    big = int.from_bytes(head[2:4], order) == 43  # BigTIFF
    count, entry, offset = (8, 20, 8) if big else (2, 12, 4)  # bytes of each
    place = int.from_bytes(head[8:16] if big else head[4:8], order)
    pages, seen = 0, set[int]()
    while place and place not in seen and len(seen) < _MOST_CHUNKS:
        seen.add(place)
        file.seek(place)
        entries = int.from_bytes(file.read(count), order)
        table = file.read(entries * entry + offset) if entries < _MOST_CHUNKS else b""
        if len(table) < entries * entry + offset:
            break  # truncated: the error is raised when the file is decoded
        tags = [table[at : at + entry] for at in range(0, entries * entry, entry)]
        value = entry - (8 if big else 4)
        kinds = [
            int.from_bytes(tag[value : value + 4], order)
            for tag in tags
            if int.from_bytes(tag[:2], order) == SUBFILE
        ]
        pages += not any(kind & NO_PAGE for kind in kinds)
        place = int.from_bytes(table[-offset:], order)
    return pages


def _frames_of_gif(path: Path, data: bytes) -> int:
    """Return the number of frames of a GIF."""
    count = 0
    try:
        at = _after_head(data)
        while at < len(data) and data[at] != _END:
            if data[at] == _EXTENSION:
                at = _after_blocks(data, at + 2)
            elif data[at] == _IMAGE:
                at = _after_blocks(data, at + 11 + _table(data[at + 9]))
                count += 1
            else:
                return count  # trailing garbage: browsers show the frames before it
    except IndexError:
        raise InputError(f"{path} is broken: it ends within its frame {count + 1}.") from None
    return count


def _after_head(data: bytes) -> int:
    """Return the offset of the first block of a GIF."""
    return 13 + _table(data[10])


def _table(flags: int) -> int:
    """Return the size of a colour table in bytes."""
    return 3 * 2 ** ((flags & 7) + 1) if flags & 0x80 else 0


def _after_blocks(data: bytes, at: int) -> int:
    """Return the offset after the sub-blocks that start at ``at``."""
    while data[at]:
        at += data[at] + 1
        if at >= len(data):
            raise IndexError
    return at + 1


def encode_animation(
    kind: Kind, frames: Sequence[NDArray[np.uint8]], durations: Sequence[int], loop: int
) -> bytes:
    """Return the content of an animation file; WebP and PNG are lossless, GIF has 256 colours per frame.

    Args:
        kind: format of the file.
        frames: (H, W, 3) or (H, W, 4) each; at least one.
        durations: duration of each frame in milliseconds.
        loop: number of times the animation plays; 0 loops forever.
    """
    images = [Image.fromarray(each) for each in frames]
    match kind:
        case "gif":
            return _gif(images, durations, loop, transparent=frames[0].shape[2] == 4)
        case "webp":
            return _webp(images, durations, loop)
        case "png":
            return _apng(images, frames, durations, loop)


def _gif(images: Sequence[Image.Image], durations: Sequence[int], loop: int, transparent: bool) -> bytes:
    """Return a GIF with every frame, even if consecutive frames are equal."""
    file = io.BytesIO()
    # The previous frame must not show through transparent pixels.
    shown = 2 if transparent else 1
    once = {} if loop == 1 else {"loop": loop}
    # Pillow merges equal frames and sums their durations. Each frame is saved with a duration of 1/100 s, so
    # the sum is the number of merged frames. They are then repeated with their own durations.
    images[0].save(file, "GIF", save_all=True, append_images=images[1:], duration=10, disposal=shown, **once)
    data, waits = file.getvalue(), iter(durations)
    at = _after_head(data)
    parts = [data[:at]]
    control = b""
    while data[at] != _END:
        start = at
        if data[at] == _EXTENSION:
            at = _after_blocks(data, at + 2)
            if data[start + 1] == _CONTROL:
                control = data[start:at]
            else:
                parts.append(data[start:at])
            continue
        at = _after_blocks(data, at + 11 + _table(data[at + 9]))
        for _ in range(int.from_bytes(control[4:6], "little")):
            wait = min(next(waits) // 10, 0xFFFF).to_bytes(2, "little")
            parts += [control[:4], wait, control[6:], data[start:at]]
    return b"".join([*parts, data[at:]])


def _webp(images: Sequence[Image.Image], durations: Sequence[int], loop: int) -> bytes:
    """Return a WebP whose frames are encoded separately, because libwebp merges equal frames.

    The container follows RFC 9649, section 2.7.
    """
    width, height = images[0].size
    canvas = (width - 1).to_bytes(3, "little") + (height - 1).to_bytes(3, "little")
    frames = []
    for image, duration in zip(images, durations, strict=True):
        file = io.BytesIO()
        image.save(file, "WEBP", lossless=True, exact=True, quality=50)
        still = file.getvalue()
        at = still.index(b"VP8L", 12)
        pixels = still[at : at + 8 + int.from_bytes(still[at + 4 : at + 8], "little")]
        wait = min(duration, 0xFFFFFF).to_bytes(3, "little")
        # The frame lies at the canvas's upper left and replaces the previous one without blending.
        frames.append(
            _chunk(b"ANMF", bytes(6) + canvas + wait + b"\x02" + pixels + b"\0" * (len(pixels) % 2))
        )
    flags = 0x02 | (0x10 if images[0].mode == "RGBA" else 0)
    head = _chunk(b"VP8X", bytes([flags, 0, 0, 0]) + canvas)
    return _chunk(
        b"RIFF", b"".join([b"WEBP", head, _chunk(b"ANIM", bytes(4) + loop.to_bytes(2, "little")), *frames])
    )


def _chunk(name: bytes, content: bytes) -> bytes:
    """Return a RIFF chunk, padded to an even length."""
    return name + len(content).to_bytes(4, "little") + content + b"\0" * (len(content) % 2)


def _apng(
    images: Sequence[Image.Image], frames: Sequence[NDArray[np.uint8]], durations: Sequence[int], loop: int
) -> bytes:
    """Return an animated PNG with every frame, even if consecutive frames are equal."""
    # Pillow merges equal frames that have the same disposal, so equal frames get alternating ones. The
    # disposal is not visible, because Pillow also draws the cleared pixels.
    disposals = [0]
    for before, each in pairwise(frames):
        disposals.append(1 - disposals[-1] if np.array_equal(before, each) else 0)
    file = io.BytesIO()
    images[0].save(
        file,
        "PNG",
        save_all=True,
        append_images=images[1:],
        duration=list(durations),
        disposal=disposals,
        loop=loop,
        blend=0,
    )
    return file.getvalue()
