"""Aseprite files: https://github.com/aseprite/aseprite/blob/main/docs/ase-file-specs.md."""

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..opening import MOST_PARTS, MOST_PIXELS, RefusedError
from .base import Layer, LayeredFile, flattened

if TYPE_CHECKING:
    from PIL.Image import Image

_FRAME = 0xF1FA
_LAYER, _CEL, _PALETTE, _TILESET = 0x2004, 0x2005, 0x2019, 0x2023
_OLD_PALETTES = {0x0004: 255, 0x0011: 63}
"""Old palette chunks with their maximum level, still written if no colour is translucent."""
_BACKGROUND, _REFERENCE = 8, 64
"""Flags of background layers, which are opaque, and of reference layers, which Aseprite does not export."""
_GROUP, _TILES = 1, 2
_BLEND_MODES = (
    *("normal", "multiply", "screen", "overlay", "darken", "lighten", "color dodge", "color burn"),
    *("hard light", "soft light", "difference", "exclusion", "hue", "saturation", "color", "luminosity"),
    *("addition", "subtract", "divide"),
)
"""The blend modes of Aseprite, by index."""
_FLIPS = (5, 1, 0)
"""Pillow's constants for flips along the diagonal, top to bottom, and left to right."""


@dataclass(frozen=True)
class _Tileset:
    """The tiles of a tilemap.

    Args:
        size: (width, height) of a tile.
        count: number of tiles.
        pixels: pixels of all tiles, stacked vertically; None if they are in another file.
        zero_is_empty: whether tile 0 is empty.
    """

    size: tuple[int, int]
    count: int
    pixels: bytes | None
    zero_is_empty: bool


@dataclass(frozen=True)
class _LayerChunk:
    """The properties of a layer in an Aseprite file.

    Args:
        name: name of the layer.
        groups: names of the groups around it.
        opacity: opacity, multiplied by that of the groups.
        visible: whether it is a visible layer and not a group.
        opaque: whether the layer has no transparent colour.
        tileset: index of the layer's tileset; None if it has no tiles.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    visible: bool
    opaque: bool
    tileset: int | None


class AsepriteFile(LayeredFile):
    """An Aseprite file, still or animated."""

    def __init__(self, content: bytes, check_size: Callable[[int, int], None]) -> None:
        super().__init__(content, check_size)
        self._broken, self._drawn = "", False
        frames, self._depth, self._flags, self._clear, colours = struct.unpack(
            "<6xH4xHI10xB3xH", content[:34]
        )
        if not 0 < frames <= MOST_PARTS:
            raise RefusedError(f"has {frames} frames; 1 to {MOST_PARTS} can be read")
        self.durations = []
        self._layers: list[_LayerChunk] = []
        self._levels: list[tuple[bool, str, int]] = []
        self._tilesets: dict[int, _Tileset] = {}
        # An index outside the palette is transparent. Old files do not give the number of colours.
        self._palette = [(0, 0, 0, 255)] * (colours or 256)
        self._palettes: list[list[tuple[int, int, int, int]]] = []
        self._old_palette = True
        self._cels: list[dict[int, bytes]] = []
        try:
            at = 128
            for _ in range(frames):
                length, magic, old, duration, new = struct.unpack_from("<IHHH2xI", content, at)
                if magic != _FRAME:
                    raise RefusedError("is an Aseprite file of an unknown version")
                self.durations.append(duration)
                self._cels.append({})
                inner = at + 16
                for _ in range(new or old):
                    size, kind = struct.unpack_from("<IH", content, inner)
                    if size < 6:
                        raise RefusedError("is a broken Aseprite file: a chunk has no length")
                    self._take(kind, content[inner + 6 : inner + size])
                    inner += size
                self._palettes.append(list(self._palette))
                at += length
        except (struct.error, IndexError) as error:
            raise RefusedError(f"is a broken Aseprite file: {error}") from None

    def composite(self) -> "Image":
        """Return the first frame."""
        return next(self.frames())[0]

    def frames(self) -> "Iterator[tuple[Image, int]]":
        """Yield each frame with its duration in milliseconds."""
        for number, duration in enumerate(self.durations):
            shown = flattened(self.size, self._cels_of(number))
            if not number and self._broken and not self._drawn:
                raise RefusedError(self._broken)
            yield shown, duration

    def tileset(self) -> "tuple[Image, tuple[int, int]]":
        """Return the tiles of the first visible tilemap, stacked vertically, and the size of a tile."""
        for number, layer in enumerate(self._layers):
            found = None if layer.tileset is None or not layer.visible else self._tilesets.get(layer.tileset)
            if found is not None and found.pixels:
                width, height = found.size
                try:
                    return self._image(found.pixels, (width, height * found.count), number, 0), found.size
                except ValueError as error:
                    raise RefusedError(f"has a broken tileset of {layer.name!r}: {error}") from None
        return super().tileset()

    def _read_size(self) -> tuple[int, int]:
        width, height, depth = struct.unpack("<8xHHH", self.content[:14])
        if depth not in {8, 16, 32}:
            raise RefusedError(f"is an Aseprite file of {depth} bits; 8, 16 and 32 can be read")
        return width, height

    def _read_layers(self) -> Iterator[Layer]:
        for frame in range(len(self.durations)):
            yield from self._cels_of(frame)

    def _cels_of(self, frame: int) -> list[Layer]:
        """Return the cels of the visible layers in a frame, bottom to top."""
        found = []
        for number, layer in enumerate(self._layers):
            if not layer.visible or number not in self._cels[frame]:
                continue
            try:
                shown = self._cel(number, frame)
                (raised,) = struct.unpack_from("<h", self._cels[frame][number], 9)
            except (struct.error, ValueError, zlib.error, KeyError, IndexError) as error:
                self.notes.leave_out(
                    layer.name, f"cannot be read in frame {frame + 1}: {error}; left out", "damaged"
                )
                self._broken = self._broken or f"has a broken layer {layer.name!r}: {error}"
                continue
            if shown is None:
                continue
            left, top, own, image = shown
            cel = Layer(layer.name, layer.groups, layer.opacity * own // 255, left, top, image, number, frame)
            found.append((number + raised, raised, cel))
            self._drawn = True
        return [cel for *_, cel in sorted(found, key=lambda each: each[:2])]

    def _take(self, kind: int, data: bytes) -> None:
        if kind == _LAYER:
            self._take_layer(data)
        elif kind == _CEL:
            (number,) = struct.unpack_from("<H", data)
            self._cels[-1][number] = data
        elif kind == _TILESET:
            self._take_tileset(data)
        elif kind in _OLD_PALETTES and self._old_palette:
            self._take_old_palette(data, _OLD_PALETTES[kind])
        elif kind == _PALETTE:
            self._old_palette = False
            size, first, last = struct.unpack_from("<III", data)
            size = min(size, 256)
            self._palette = (self._palette + [(0, 0, 0, 255)] * size)[:size]
            at = 20
            for index in range(first, min(last, 255) + 1):
                flags, *colour = struct.unpack_from("<HBBBB", data, at)
                self._set(index, (colour[0], colour[1], colour[2], colour[3]))
                at += 6 + (2 + struct.unpack_from("<H", data, at + 6)[0] if flags & 1 else 0)

    def _take_layer(self, data: bytes) -> None:
        flags, what, level, blend, opacity = struct.unpack_from("<HHH4xHB", data)
        (length,) = struct.unpack_from("<H", data, 16)
        name = data[18 : 18 + length].decode("utf-8", "replace")
        above = self._levels[:level]
        visible = bool(flags & 1) and not flags & _REFERENCE and all(shown for shown, *_ in above)
        # Flags of the header: the first is set if layers have an opacity, the second if groups have one.
        opacity = opacity if self._flags & (2 if what == _GROUP else 1) else 255
        opacity = opacity * (above[-1][2] if above else 255) // 255
        self._levels[level:] = [(visible, name, opacity)]
        if visible and blend and (what != _GROUP or self._flags & 2):
            self.notes.add_blend(name, _BLEND_MODES[blend] if blend < len(_BLEND_MODES) else str(blend))
        self._layers.append(
            _LayerChunk(
                name,
                tuple(each for _, each, _ in above),
                opacity,
                visible and what != _GROUP,
                bool(flags & _BACKGROUND),
                struct.unpack_from("<I", data, 18 + length)[0] if what == _TILES else None,
            )
        )

    def _take_tileset(self, data: bytes) -> None:
        number, flags, count, width, height = struct.unpack_from("<IIIHH", data)
        (length,) = struct.unpack_from("<H", data, 32)
        at, pixels = 34 + length, None
        size = count * width * height * self._depth // 8
        if not 0 <= count * width * height <= MOST_PIXELS:
            raise RefusedError(f"has a tileset of {count} tiles of {width} × {height} pixels")
        if flags & 1:  # index of the other file and of its tileset
            at += 8
        if flags & 2:
            pixels = zlib.decompressobj().decompress(data[at + 4 :], size) if size else b""
        self._tilesets[number] = _Tileset((width, height), count, pixels, bool(flags & 4))

    def _set(self, index: int, colour: tuple[int, int, int, int]) -> None:
        self._palette += [(0, 0, 0, 255)] * (index + 1 - len(self._palette))
        self._palette[index] = colour

    def _take_old_palette(self, data: bytes, brightest: int) -> None:
        """Read the colours of an old palette chunk, which are stored in runs."""
        (runs,) = struct.unpack_from("<H", data)
        at, index = 2, 0
        for _ in range(runs):
            skipped, count = struct.unpack_from("<BB", data, at)
            at, index = at + 2, index + skipped
            for _ in range(count or 256):
                red, green, blue = (
                    min(each * 255 // brightest, 255) for each in struct.unpack_from("<BBB", data, at)
                )
                self._set(min(index, 255), (red, green, blue, 255))
                at, index = at + 3, index + 1

    def _cel(self, number: int, frame: int) -> "tuple[int, int, int, Image] | None":
        """Return left, top, opacity and picture of a cel, or None for an empty cel."""
        data = self._cels[frame][number]
        left, top, own, kind = struct.unpack_from("<2xhhBH", data)
        if kind == 1:  # linked to a cel of an earlier frame, which may be empty
            (other,) = struct.unpack_from("<H", data, 16)
            return self._cel(number, other) if other < frame and number in self._cels[other] else None
        if kind == 3:
            image = self._tilemap(number, frame, data)
            return None if image is None else (left, top, own, image)
        if kind not in {0, 2}:
            raise ValueError(f"it is of the unknown type {kind}")
        width, height = struct.unpack_from("<HH", data, 16)
        if not 0 < width * height <= MOST_PIXELS:
            raise ValueError(f"it has {width} × {height} pixels")
        count = width * height * self._depth // 8
        pixels = data[20:] if kind == 0 else zlib.decompressobj().decompress(data[20:], count)
        return left, top, own, self._image(pixels, (width, height), number, frame)

    def _image(self, pixels: bytes, size: tuple[int, int], number: int, frame: int) -> "Image":
        """Return pixels as an RGBA picture."""
        from PIL import Image

        count = size[0] * size[1] * self._depth // 8
        if len(pixels) < count:
            raise ValueError("it ends too early")
        if self._depth == 32:
            return Image.frombytes("RGBA", size, pixels[:count])
        if self._depth == 16:
            return Image.frombytes("LA", size, pixels[:count]).convert("RGBA")
        index = Image.frombytes("L", size, pixels[:count])
        palette = self._palettes[frame] + [(0, 0, 0, 0)] * (256 - len(self._palettes[frame]))
        if not self._layers[number].opaque:
            palette[self._clear] = (0, 0, 0, 0)
        return Image.merge("RGBA", [index.point([each[band] for each in palette]) for band in range(4)])

    def _tilemap(self, number: int, frame: int, data: bytes) -> "Image | None":
        """Return the picture of a tilemap cel, or None if its tileset is in another file."""
        from PIL import Image

        columns, rows, bits, numbers, *flips = struct.unpack_from("<HHHIIII", data, 16)
        layer = self._layers[number]
        tileset = self._tilesets.get(-1 if layer.tileset is None else layer.tileset)
        if tileset is None or tileset.pixels is None:
            self.notes.leave_out(
                layer.name, "tileset in another file left out; convert it to a layer", "foreign"
            )
            return None
        width, height = tileset.size
        if bits not in {8, 16, 32} or not 0 < columns * width * rows * height <= MOST_PIXELS:
            raise ValueError(f"it has {columns} × {rows} tiles of {width} × {height} pixels and {bits} bits")
        count = columns * rows
        packed = zlib.decompressobj().decompress(data[48:], count * bits // 8)
        tiles = struct.unpack_from(f"<{count}{ {8: 'B', 16: 'H', 32: 'I'}[bits] }", packed)
        strip = self._image(tileset.pixels, (width, height * tileset.count), number, frame)
        image = Image.new("RGBA", (columns * width, rows * height))
        for place, tile in enumerate(tiles):
            which = tile & numbers
            if which >= tileset.count or (which == 0 and tileset.zero_is_empty):
                continue
            part = strip.crop((0, which * height, width, (which + 1) * height))
            # The order matters, because a tile rotated by 90° is flipped along its diagonal and then
            # flipped again.
            for flip, how in zip(reversed(flips), _FLIPS, strict=True):
                part = part.transpose(Image.Transpose(how)) if tile & flip else part
            image.paste(part, (place % columns * width, place // columns * height))
        return image
