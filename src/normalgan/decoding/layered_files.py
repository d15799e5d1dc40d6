"""Layered files of paint programs, decoded in the child process: PSD, OpenRaster, Krita, Aseprite.

It imports nothing of the package, as the program that it is a part of (`worker.py`) runs without it.
"""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["UnreadableError", "aseprite_frames", "composite", "kind_of", "size_of"]

_MOST_FRAMES = 1024
_MOST_MEMBER = 2**29
"""Bytes of one file in a ZIP."""
_ASEPRITE, _ASEPRITE_FRAME = 0xA5E0, 0xF1FA
_LAYER, _CEL, _PALETTE, _OLD_PALETTE = 0x2004, 0x2005, 0x2019, 0x0004


class UnreadableError(Exception):
    """A layered file that cannot be read; its text goes after the file's name."""


@dataclass
class _Layer:
    """A visible layer.

    Args:
        name: as the file has it.
        left: of its first column in the picture; may be negative.
        top: of its first row.
        image: RGBA.
    """

    name: str
    left: int
    top: int
    image: "Image"


def kind_of(content: bytes) -> str | None:
    """Return the kind of a layered file: psd, zip (OpenRaster or Krita) or aseprite; None of any other file.

    >>> kind_of(b"8BPS..."), kind_of(b"GIF89a")
    ('psd', None)
    """
    if content.startswith(b"8BPS"):
        return "psd"
    if content.startswith(b"PK\x03\x04"):
        return "zip"
    if len(content) >= 128 and content[4:6] == _ASEPRITE.to_bytes(2, "little"):
        return "aseprite"
    return None


def size_of(content: bytes) -> tuple[int, int]:
    """Return (width, height), before anything is decoded.

    Raises:
        UnreadableError: if the file is broken or of an unknown version.
    """
    match kind_of(content):
        case "psd":
            version, height, width = struct.unpack(">4xH8xII", content[:22].ljust(22, b"\0"))
            if version not in {1, 2}:
                raise UnreadableError(f"is a PSD of version {version}; 1 and 2 can be read")
            return width, height
        case "aseprite":
            width, height, depth = struct.unpack("<8xHHH", content[:14])
            if depth not in {8, 16, 32}:
                raise UnreadableError(f"is an Aseprite file of {depth} bits; 8, 16 and 32 can be read")
            return width, height
        case _:
            return _merged(content).size


def composite(content: bytes) -> "Image":
    """Return what a layered file shows; of an Aseprite file its first frame.

    Raises:
        UnreadableError: if it cannot be read.
    """
    match kind_of(content):
        case "psd":
            psd = _psd(content)
            found = psd.topil() if psd.has_preview() else psd.composite()
            if found is None:
                raise UnreadableError("holds no picture")
            image: Image = found
            return image
        case "aseprite":
            return next(aseprite_frames(content))[0]
        case _:
            return _merged(content)


def aseprite_frames(content: bytes) -> "Iterator[tuple[Image, int]]":
    """Yield the frames of an Aseprite file, and how many milliseconds each is shown."""
    from PIL import Image

    file = _Aseprite(content)
    for number, duration in enumerate(file.durations):
        canvas = Image.new("RGBA", file.size)
        for cel in file.cels(number):
            over = Image.new("RGBA", file.size)
            over.paste(cel.image, (cel.left, cel.top))
            canvas = Image.alpha_composite(canvas, over)
        yield canvas, duration


def _psd(content: bytes) -> Any:
    from psd_tools import PSDImage

    return PSDImage.open(io.BytesIO(content))


def _faded(image: "Image", opacity: int) -> "Image":
    image = image.convert("RGBA")
    if opacity < 255:
        image.putalpha(image.getchannel("A").point([value * opacity // 255 for value in range(256)]))
    return image


def _zip(content: bytes) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(io.BytesIO(content))
    except (zipfile.BadZipFile, ValueError) as error:
        raise UnreadableError(f"is a broken ZIP: {error}") from None


def _member(file: zipfile.ZipFile, name: str) -> bytes:
    try:
        about = file.getinfo(name)
        if about.file_size > _MOST_MEMBER:
            raise UnreadableError(f"has more than {_MOST_MEMBER} bytes in its {name}")
        with file.open(about) as member:
            return member.read(_MOST_MEMBER)
    except KeyError:
        raise UnreadableError(f"is a ZIP without {name}; OpenRaster and Krita files have one") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise UnreadableError(f"is broken: {error}") from None


def _png(data: bytes) -> "Image":
    from PIL import Image

    return Image.open(io.BytesIO(data), formats=("PNG",))


def _merged(content: bytes) -> "Image":
    with _zip(content) as file:
        return _png(_member(file, "mergedimage.png"))


class _Aseprite:
    """An Aseprite file: https://github.com/aseprite/aseprite/blob/main/docs/ase-file-specs.md."""

    def __init__(self, content: bytes) -> None:
        self.size = size_of(content)
        frames, self._depth, self._clear = struct.unpack("<6xH4xH14xB", content[:29])
        if not 0 < frames <= _MOST_FRAMES:
            raise UnreadableError(f"has {frames} frames; 1 to {_MOST_FRAMES} can be read")
        self.durations: list[int] = []
        self._visible: list[bool] = []
        self._names: list[tuple[str, int]] = []
        self._levels: list[bool] = []
        self._palette = [(0, 0, 0, 255)] * 256
        self._cels: list[dict[int, tuple[int, bytes]]] = []
        try:
            at = 128
            for _ in range(frames):
                length, magic, old, duration, new = struct.unpack_from("<IHHH2xI", content, at)
                if magic != _ASEPRITE_FRAME:
                    raise UnreadableError("is an Aseprite file of an unknown version")
                self.durations.append(duration)
                self._cels.append({})
                inner = at + 16
                for _ in range(new or old):
                    size, kind = struct.unpack_from("<IH", content, inner)
                    if size < 6:
                        raise UnreadableError("is a broken Aseprite file: a chunk has no length")
                    self._take(kind, content[inner + 6 : inner + size])
                    inner += size
                at += length
        except (struct.error, IndexError) as error:
            raise UnreadableError(f"is a broken Aseprite file: {error}") from None

    def cels(self, frame: int) -> list[_Layer]:
        """Return the visible layers of a frame, the lowest first."""
        found = []
        for number, visible in enumerate(self._visible):
            if visible and number in self._cels[frame]:
                name, opacity = self._names[number]
                try:
                    found.append(self._cel(name, opacity, number, frame))
                except (struct.error, ValueError, zlib.error, KeyError, IndexError) as error:
                    raise UnreadableError(f"has a broken layer {name!r}: {error}") from None
        return found

    def _take(self, kind: int, data: bytes) -> None:
        if kind == _LAYER:
            flags, what, level, opacity = struct.unpack_from("<HHH6xB", data)
            visible = bool(flags & 1) and all(self._levels[:level])
            self._levels[level:] = [visible]
            self._visible.append(visible and what == 0)
            (length,) = struct.unpack_from("<H", data, 16)
            self._names.append((data[18 : 18 + length].decode("utf-8", "replace"), opacity))
        elif kind == _CEL:
            (number,) = struct.unpack_from("<H", data)
            self._cels[-1][number] = (len(self._cels) - 1, data)
        elif kind == _PALETTE:
            first, last = struct.unpack_from("<4xII", data)
            at = 20
            for index in range(first, min(last, 255) + 1):
                flags, *colour = struct.unpack_from("<HBBBB", data, at)
                self._palette[index] = (colour[0], colour[1], colour[2], colour[3])
                at += 6 + (2 + struct.unpack_from("<H", data, at + 6)[0] if flags & 1 else 0)

    def _cel(self, name: str, opacity: int, number: int, frame: int) -> _Layer:
        from PIL import Image

        data = self._cels[frame][number][1]
        left, top, own, kind = struct.unpack_from("<2xhhBH", data)
        if kind == 1:  # as in another frame
            (other,) = struct.unpack_from("<H", data, 16)
            if other >= frame:
                raise ValueError("it refers to a later frame")
            return self._cel(name, opacity, number, other)
        if kind not in {0, 2}:
            raise ValueError("it is made of tiles, which cannot be read")
        width, height = struct.unpack_from("<HH", data, 16)
        if not 0 < width * height <= 2**26:
            raise ValueError(f"it has {width} × {height} pixels")
        count = width * height * self._depth // 8
        pixels = data[20:] if kind == 0 else zlib.decompressobj().decompress(data[20:], count)
        if len(pixels) < count:
            raise ValueError("it ends too early")
        size = width, height
        if self._depth == 32:
            image = Image.frombytes("RGBA", size, pixels[:count])
        elif self._depth == 16:
            image = Image.frombytes("LA", size, pixels[:count])
        else:
            index = Image.frombytes("L", size, pixels[:count])
            palette = list(self._palette)
            palette[self._clear] = (0, 0, 0, 0)
            bands = [index.point([colour[band] for colour in palette]) for band in range(4)]
            image = Image.merge("RGBA", bands)
        return _Layer(name, left, top, _faded(image, opacity * own // 255))
