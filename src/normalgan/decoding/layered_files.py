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

__all__ = [
    "Layer",
    "UnreadableError",
    "aseprite_frames",
    "composite",
    "durations_of",
    "kind_of",
    "layers",
    "size_of",
]

_MOST_FRAMES = 1024
_MOST_MEMBER = 2**29
"""Bytes of one file in a ZIP."""
_ASEPRITE, _ASEPRITE_FRAME = 0xA5E0, 0xF1FA
_LAYER, _CEL, _PALETTE = 0x2004, 0x2005, 0x2019
_OLD_PALETTES = {0x0004: 255, 0x0011: 63}
"""Aseprite 1.3.5 and later write the first of them alone where no colour is translucent; its brightest."""
_BACKGROUND, _REFERENCE = 8, 64
"""Layers of Aseprite in which no colour is transparent, and those to draw after, which it does not export."""
_GROUP = 1
_TILE = 64
"""Columns and rows of a tile of a Krita layer."""
_ALTERS = {"adjustmentlayer", "generatorlayer"}
"""Layers of Krita that alter what is below, or fill everything: nothing is drawn on them."""


class UnreadableError(Exception):
    """A layered file that cannot be read; its text goes after the file's name."""


@dataclass
class Layer:
    """A visible layer, or what it shows in one frame.

    Args:
        name: as the file has it.
        groups: names of those that it lies in, the outermost first.
        opacity: 0 to 255, with that of its groups; the image does not have it.
        left: of its first column in the picture; may be negative.
        top: of its first row.
        image: RGBA.
        number: of the layer, counted from the lowest.
        frame: in which it shows this.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    left: int
    top: int
    image: "Image"
    number: int = 0
    frame: int = 0


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
            over.paste(_faded(cel.image, cel.opacity), (cel.left, cel.top))
            canvas = Image.alpha_composite(canvas, over)
        yield canvas, duration


def durations_of(content: bytes) -> list[int]:
    """Return how many milliseconds each frame is shown; one frame of none of what does not move."""
    return _Aseprite(content).durations if kind_of(content) == "aseprite" else [0]


def layers(content: bytes) -> Iterator[Layer]:
    """Yield the visible layers that something is drawn on, the lowest first, cut to what is opaque in them.

    Those of an Aseprite file come frame by frame. What only alters the layers below it is left out.

    Raises:
        UnreadableError: if one cannot be read.
    """
    width, height = size_of(content)
    match kind_of(content):
        case "psd":
            found = _psd_layers(content)
        case "aseprite":
            file = _Aseprite(content)
            found = (cel for frame in range(len(file.durations)) for cel in file.cels(frame))
        case _:
            found = _zip_layers(content)
    for number, each in enumerate(found):
        box = max(-each.left, 0), max(-each.top, 0), width - each.left, height - each.top
        image = each.image.convert("RGBA")
        right, bottom = min(box[2], image.width), min(box[3], image.height)
        if right <= box[0] or bottom <= box[1]:
            continue  # all of it lies beside the picture
        image = image.crop((box[0], box[1], right, bottom))
        opaque = image.getchannel("A").getbbox()
        if opaque is None:
            continue
        each.image = image.crop(opaque)
        each.left, each.top = each.left + box[0] + opaque[0], each.top + box[1] + opaque[1]
        if kind_of(content) != "aseprite":
            each.number = number
        yield each


def _psd_layers(content: bytes) -> Iterator[Layer]:
    psd = _psd(content)
    if psd.color_mode.name not in {"RGB", "GRAYSCALE"}:
        raise UnreadableError(
            f"has its colours in {psd.color_mode.name}; layers of RGB and of greys can be painted"
        )
    return _psd_group(psd, (), 255)


def _psd_group(group: Any, path: tuple[str, ...], opacity: int) -> Iterator[Layer]:
    for layer in group:
        if not layer.visible:
            continue
        own = opacity * layer.opacity // 255
        if layer.is_group():
            yield from _psd_group(layer, (*path, layer.name), own)
            continue
        image = layer.topil() if layer.has_pixels() else None
        if image is not None:
            yield Layer(layer.name, path, own, layer.left, layer.top, _masked(layer, image))
        elif layer.kind in {"shape", "smartobject", "type"}:
            raise UnreadableError(f"has a layer {layer.name!r} without pixels; rasterize it, or hide it")


def _masked(layer: Any, image: "Image") -> "Image":
    """Return the picture of a PSD's layer with its mask in its opacity."""
    from PIL import Image, ImageChops

    image, mask = image.convert("RGBA"), layer.mask
    if mask is None or mask.disabled:
        return image
    whole = Image.new("L", image.size, mask.background_color)
    part = mask.topil()
    if part is not None:
        whole.paste(part.convert("L"), (mask.left - layer.left, mask.top - layer.top))
    image.putalpha(ImageChops.multiply(image.getchannel("A"), whole))
    return image


def _zip_layers(content: bytes) -> Iterator[Layer]:
    from xml.etree import ElementTree as Tree

    with _zip(content) as file:
        krita = "maindoc.xml" in file.namelist()
        name = "maindoc.xml" if krita else "stack.xml"
        try:
            root = Tree.fromstring(_member(file, name))
        except Tree.ParseError as error:
            raise UnreadableError(f"has a broken {name}: {error}") from None
        for each in root.iter():
            each.tag = each.tag.rpartition("}")[2]
        if krita:
            yield from _krita_layers(file, root.find("IMAGE/layers"), (), 255)
        else:
            yield from _openraster_layers(file, root.find("stack"), (), 1.0)


def _openraster_layers(
    file: zipfile.ZipFile, stack: Any, path: tuple[str, ...], opacity: float
) -> Iterator[Layer]:
    """Yield the layers of a stack; https://www.openraster.org/baseline/layer-stack-spec.html."""
    for each in reversed(stack if stack is not None else ()):
        name = each.get("name", "")
        if each.get("visibility") == "hidden":
            continue
        try:
            own = opacity * min(max(float(each.get("opacity", "1")), 0.0), 1.0)
            left, top = int(each.get("x", "0")), int(each.get("y", "0"))
        except ValueError as error:
            raise UnreadableError(f"has a broken layer {name!r}: {error}") from None
        if each.tag == "stack":
            yield from _openraster_layers(file, each, (*path, name), own)
        elif each.tag == "layer":
            image = _png(_member(file, each.get("src", "")))
            yield Layer(name, path, round(255 * own), left, top, image)


def _krita_layers(file: zipfile.ZipFile, group: Any, path: tuple[str, ...], opacity: int) -> Iterator[Layer]:
    for each in reversed(group if group is not None else ()):
        name, kind = each.get("name", ""), each.get("nodetype", "")
        if each.get("visible", "1") == "0" or kind in _ALTERS:
            continue
        masks = [mask.get("nodetype") for mask in each.findall("masks/mask") if mask.get("visible") != "0"]
        if any(mask in {"transparencymask", "filtermask", "transformmask"} for mask in masks):
            raise UnreadableError(f"has a layer {name!r} with a mask that only Krita applies; flatten it")
        try:
            own = opacity * min(max(int(each.get("opacity", "255")), 0), 255) // 255
            at = int(each.get("x", "0")), int(each.get("y", "0"))
            if kind == "grouplayer":
                yield from _krita_layers(file, each.find("layers"), (*path, name), own)
            elif kind == "paintlayer":
                yield Layer(name, path, own, 0, 0, _krita_pixels(file, each, at))
            else:
                raise UnreadableError(f"has a layer {name!r} of the kind {kind}; rasterize it, or hide it")
        except (ValueError, IndexError) as error:
            raise UnreadableError(f"has a broken layer {name!r}: {error}") from None


def _krita_pixels(file: zipfile.ZipFile, layer: Any, at: tuple[int, int]) -> "Image":
    """Return the picture of a paint layer, as large as the whole.

    The format is that of Krita's ``KisTiledDataManager`` and ``KisTileCompressor2``: lines of text, and then
    tiles, each with a line that says where it lies, and its bytes, one plane after the other, packed by LZF.

    Raises:
        ValueError: if it is broken, and so is `IndexError`.
    """
    across, down = at
    ending = f"/layers/{layer.get('filename', '')}"
    name = next((each for each in file.namelist() if each.endswith(ending)), ending[1:])
    space = layer.get("colorspacename", "RGBA")
    bands = {"RGBA": "BGRA", "GRAYA": "LA"}.get(space)
    if bands is None:
        raise ValueError(f"it has its colours in {space}, and not in 8 bits of RGBA or GRAYA")
    data, here, about = _member(file, name), 0, {}
    while "DATA" not in about:
        key, _, value = data[here : (end := data.index(b"\n", here))].decode("ascii").partition(" ")
        about[key], here = int(value), end + 1
    if (about.get("TILEWIDTH"), about.get("TILEHEIGHT"), about.get("PIXELSIZE")) != (
        _TILE,
        _TILE,
        len(bands),
    ):
        raise ValueError("it has tiles or pixels of another size than 64 × 64 and 8 bits a channel")
    ground = bytes(len(bands))
    if f"{name}.defaultpixel" in file.namelist():
        ground = _member(file, f"{name}.defaultpixel")[: len(bands)].ljust(len(bands), b"\0")
    whole = _from_bands(ground, bands, (1, 1)).resize(_png(_member(file, "mergedimage.png")).size)
    for _ in range(about["DATA"]):
        left, top, packing, count = data[here : (end := data.index(b"\n", here))].decode("ascii").split(",")
        here = end + 1 + int(count)
        if packing != "LZF" or here > len(data):
            raise ValueError("a tile of it is packed in a way that is not known, or ends too early")
        whole.paste(_tile(data[end + 1 : here], bands), (int(left) + across, int(top) + down))
    return whole


def _tile(packed: bytes, bands: str) -> "Image":
    from PIL import Image

    count = _TILE * _TILE * len(bands)
    if packed[0] == 0:
        return _from_bands(packed[1 : 1 + count], bands, (_TILE, _TILE))
    planes = _unpacked(packed[1:], count)
    side = _TILE * _TILE
    own = [Image.frombytes("L", (_TILE, _TILE), planes[i : i + side]) for i in range(0, count, side)]
    ordered = (own[2], own[1], own[0], own[3]) if bands == "BGRA" else (own[0], own[0], own[0], own[1])
    return Image.merge("RGBA", ordered)


def _from_bands(data: bytes, bands: str, size: tuple[int, int]) -> "Image":
    from PIL import Image

    mode = "RGBA" if bands == "BGRA" else "LA"
    return Image.frombytes(mode, size, data, "raw", bands).convert("RGBA")


def _unpacked(packed: bytes, count: int) -> bytes:
    r"""Return bytes that LZF has packed.

    Raises:
        ValueError: if they are not as many as ``count``.

    >>> _unpacked(b"\x01ab\x60\x01", 7)
    b'abababa'
    """
    out, at = bytearray(), 0
    while at < len(packed) and len(out) < count:
        control = packed[at]
        at += 1
        if control < 32:  # so many bytes as they are, and one
            out += packed[at : at + control + 1]
            at += control + 1
            continue
        length = (control >> 5) + 2
        if length == 9:
            length += packed[at]
            at += 1
        back = ((control & 31) << 8 | packed[at]) + 1
        at += 1
        if back > len(out):
            raise ValueError("a tile of it refers to what is before its start")
        once = bytes(out[len(out) - back : len(out) - back + length])
        out += (once * (length // len(once) + 1))[:length]
    if len(out) != count:
        raise ValueError(f"a tile of it has {len(out)} bytes in place of {count}")
    return bytes(out)


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
        frames, self._depth, self._flags, self._clear = struct.unpack("<6xH4xHI10xB", content[:29])
        if not 0 < frames <= _MOST_FRAMES:
            raise UnreadableError(f"has {frames} frames; 1 to {_MOST_FRAMES} can be read")
        self.durations: list[int] = []
        self._visible: list[bool] = []
        self._names: list[tuple[str, tuple[str, ...], int]] = []
        self._opaque: list[bool] = []
        self._levels: list[tuple[bool, str, int]] = []
        self._palette = [(0, 0, 0, 255)] * 256
        self._old_palette = True
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

    def cels(self, frame: int) -> list[Layer]:
        """Return the visible layers of a frame, the lowest first."""
        found = []
        for number, visible in enumerate(self._visible):
            if visible and number in self._cels[frame]:
                name, groups, opacity = self._names[number]
                try:
                    left, top, own, image = self._cel(number, frame)
                    (raised,) = struct.unpack_from("<h", self._cels[frame][number][1], 9)
                except (struct.error, ValueError, zlib.error, KeyError, IndexError) as error:
                    raise UnreadableError(f"has a broken layer {name!r}: {error}") from None
                cel = Layer(name, groups, opacity * own // 255, left, top, image, number, frame)
                found.append((number + raised, raised, cel))
        return [cel for *_, cel in sorted(found, key=lambda each: each[:2])]

    def _take(self, kind: int, data: bytes) -> None:
        if kind == _LAYER:
            flags, what, level, opacity = struct.unpack_from("<HHH6xB", data)
            (length,) = struct.unpack_from("<H", data, 16)
            name = data[18 : 18 + length].decode("utf-8", "replace")
            above = self._levels[:level]
            visible = bool(flags & 1) and not flags & _REFERENCE and all(shown for shown, *_ in above)
            # The second flag of the header says that groups have an opacity, the first that layers have one.
            opacity = opacity if self._flags & (2 if what == _GROUP else 1) else 255
            opacity = opacity * (above[-1][2] if above else 255) // 255
            self._levels[level:] = [(visible, name, opacity)]
            self._visible.append(visible and what != _GROUP)
            self._opaque.append(bool(flags & _BACKGROUND))
            self._names.append((name, tuple(each for _, each, _ in above), opacity))
        elif kind == _CEL:
            (number,) = struct.unpack_from("<H", data)
            self._cels[-1][number] = (len(self._cels) - 1, data)
        elif kind in _OLD_PALETTES and self._old_palette:
            self._take_old_palette(data, _OLD_PALETTES[kind])
        elif kind == _PALETTE:
            self._old_palette = False
            first, last = struct.unpack_from("<4xII", data)
            at = 20
            for index in range(first, min(last, 255) + 1):
                flags, *colour = struct.unpack_from("<HBBBB", data, at)
                self._palette[index] = (colour[0], colour[1], colour[2], colour[3])
                at += 6 + (2 + struct.unpack_from("<H", data, at + 6)[0] if flags & 1 else 0)

    def _take_old_palette(self, data: bytes, brightest: int) -> None:
        """Take the colours of a chunk in which runs of them follow one another."""
        (runs,) = struct.unpack_from("<H", data)
        at, index = 2, 0
        for _ in range(runs):
            skipped, count = struct.unpack_from("<BB", data, at)
            at, index = at + 2, index + skipped
            for _ in range(count or 256):
                red, green, blue = (
                    min(each * 255 // brightest, 255) for each in struct.unpack_from("<BBB", data, at)
                )
                self._palette[index] = (red, green, blue, 255)
                at, index = at + 3, index + 1

    def _cel(self, number: int, frame: int) -> "tuple[int, int, int, Image]":
        """Return left, top, opacity and picture of what a layer shows in a frame."""
        from PIL import Image

        data = self._cels[frame][number][1]
        left, top, own, kind = struct.unpack_from("<2xhhBH", data)
        if kind == 1:  # as in another frame
            (other,) = struct.unpack_from("<H", data, 16)
            if other >= frame:
                raise ValueError("it refers to a later frame")
            return self._cel(number, other)
        if kind not in {0, 2}:
            name = self._names[number][0]
            raise UnreadableError(
                f"has a layer {name!r} of tiles, which cannot be read; convert it to a layer, or hide it"
            )
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
            if not self._opaque[number]:
                palette[self._clear] = (0, 0, 0, 0)
            bands = [index.point([colour[band] for colour in palette]) for band in range(4)]
            image = Image.merge("RGBA", bands)
        return left, top, own, image
