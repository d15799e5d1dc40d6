"""Krita files (KRA), with layers of LZF-compressed tiles."""

import zipfile
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..opening import RefusedError
from .base import Layer
from .zips import MERGED, LayeredZip, member_of, xml_of

if TYPE_CHECKING:
    from PIL.Image import Image

_TILE = 64
"""Number of columns and rows of a tile in a Krita layer."""
_LAYERS = {
    "adjustmentlayer": "filter layer",
    "generatorlayer": "fill layer",
    "shapelayer": "vector layer",
    "filelayer": "file layer",
    "clonelayer": "clone layer",
}
"""Krita layers without pixels of their own, by their type in the file."""
_MASKS = {"filtermask": "filter mask", "transformmask": "transform mask", "colorizemask": "colorize mask"}
_ANIMATED = "it is animated in Krita;"
_WAY_OUT = "is used; render the animation as GIF, WebP or PNG files for all frames"


class KritaFile(LayeredZip):
    """A Krita file."""

    def composite(self) -> "Image":
        """Return the merged picture that Krita saved, or else the composite of the layers."""
        shown = super().composite()
        if self._moment is not None and MERGED in self.zip.namelist():
            self.notes.add_file(f"{_ANIMATED} the picture that Krita merged when it was saved {_WAY_OUT}")
        return shown

    def _described_size(self) -> tuple[str, str]:
        about = self._root.find("IMAGE")
        return ("", "") if about is None else (about.get("width", ""), about.get("height", ""))

    def _read_layers(self) -> Iterator[Layer]:
        if self._moment is not None:
            frame = f"the frame {self._moment}, at which it was saved,"
            self.notes.add_file(f"{_ANIMATED} {frame} {_WAY_OUT}")
        yield from self._group(self._root.find("IMAGE/layers"), (), 255, ())

    @cached_property
    def _root(self) -> Any:
        return xml_of(self.zip, "maindoc.xml")

    @cached_property
    def _moment(self) -> int | None:
        """The current time of an animated file; None for a still file."""
        times = {time for each in self._root.iter("layer") for time, _ in _keyframes(self.zip, each)}
        if len(times) < 2:
            return None
        current = self._root.find("IMAGE/animation/currentTime")
        try:
            return int(current.get("value")) if current is not None else 0
        except (TypeError, ValueError):
            return 0

    def _group(
        self, group: Any, path: tuple[str, ...], opacity: int, masks: "tuple[Image, ...]"
    ) -> Iterator[Layer]:
        """Yield the layers of a group, bottom to top, given the masks of the surrounding groups."""
        from PIL import ImageChops

        for each in reversed(group if group is not None else ()):
            name, kind = each.get("name", ""), each.get("nodetype", "")
            if each.get("visible", "1") == "0":
                continue
            if kind not in {"grouplayer", "paintlayer"}:
                words = f"{_LAYERS.get(kind, f'layer of the kind {kind}')} left out"
                if kind == "adjustmentlayer":
                    self.notes.add(name, words)
                else:
                    self.notes.leave_out(name, words, "foreign")
                continue
            self._note(each, name)
            try:
                own = opacity * min(max(int(each.get("opacity", "255")), 0), 255) // 255
                inside = (*masks, *self._masks(each, name))
                if kind == "grouplayer":
                    yield from self._group(each.find("layers"), (*path, name), own, inside)
                    continue
                image = self._paint(each)
            except (ValueError, IndexError, RefusedError) as error:
                self.notes.leave_out(name, f"cannot be read: {error}; left out", "damaged")
                continue
            for mask in inside:
                image.putalpha(ImageChops.multiply(image.getchannel("A"), mask))
            yield Layer(name, path, own, 0, 0, image)

    def _note(self, layer: Any, name: str) -> None:
        mode = layer.get("compositeop", "normal")
        if mode not in {"normal", "passthrough"}:
            self.notes.add_blend(name, mode)
        if layer.get("channelflags", "").endswith("0"):
            self.notes.add(name, "clipping (inherit alpha) left out")
        if layer.get("layerstyle"):
            self.notes.add(name, "layer style left out")

    def _masks(self, layer: Any, name: str) -> "list[Image]":
        """Return a layer's transparency masks at the size of the picture, and add notes on other masks."""
        found = []
        for each in layer.findall("masks/mask"):
            kind = each.get("nodetype", "")
            if each.get("visible") == "0":
                continue
            if kind == "transparencymask":
                at = int(each.get("x", "0")), int(each.get("y", "0"))
                found.append(self._pixels(f"{each.get('filename', '')}.pixelselection", at, "L"))
            elif kind in _MASKS:
                self.notes.add(name, f"{_MASKS[kind]} left out")
        return found

    def _paint(self, layer: Any) -> "Image":
        """Return a paint layer at the size of the picture."""
        space = layer.get("colorspacename", "RGBA")
        bands = {"RGBA": "BGRA", "GRAYA": "LA"}.get(space)
        if bands is None:
            raise ValueError(f"its colours are {space} instead of 8-bit RGBA or GRAYA")
        name, at = layer.get("filename", ""), (int(layer.get("x", "0")), int(layer.get("y", "0")))
        shown = [each for time, each in _keyframes(self.zip, layer) if time <= (self._moment or 0)]
        if shown:
            offset = shown[-1].find("offset")
            name = shown[-1].get("frame", name)
            if offset is not None:
                at = at[0] + int(offset.get("x", "0")), at[1] + int(offset.get("y", "0"))
        return self._pixels(name, at, bands)

    def _pixels(self, filename: str, at: tuple[int, int], bands: str) -> "Image":
        """Return the pixels in a file of tiles, at the size of the picture.

        The format is that of Krita's ``KisTiledDataManager`` and ``KisTileCompressor2``: lines of text,
        then tiles. Each tile has a line with its position, followed by its LZF-compressed bytes, plane by
        plane.

        Raises:
            ValueError, IndexError: if the file is broken.
        """
        name = _path(self.zip, filename)
        data, here, about = member_of(self.zip, name), 0, {}
        while "DATA" not in about:
            key, _, value = data[here : (end := data.index(b"\n", here))].decode("ascii").partition(" ")
            about[key], here = int(value), end + 1
        if (about.get("TILEWIDTH"), about.get("TILEHEIGHT"), about.get("PIXELSIZE")) != (
            _TILE,
            _TILE,
            len(bands),
        ):
            raise ValueError("its tiles are not 64 × 64 pixels of 8 bits per channel")
        ground = bytes(len(bands))
        if f"{name}.defaultpixel" in self.zip.namelist():
            ground = member_of(self.zip, f"{name}.defaultpixel")[: len(bands)].ljust(len(bands), b"\0")
        whole = _from_bands(ground, bands, (1, 1)).resize(self.size)
        for _ in range(about["DATA"]):
            left, top, packing, count = (
                data[here : (end := data.index(b"\n", here))].decode("ascii").split(",")
            )
            here = end + 1 + int(count)
            if packing != "LZF" or here > len(data):
                raise ValueError("a tile has an unknown compression or is truncated")
            whole.paste(_tile(data[end + 1 : here], bands), (int(left) + at[0], int(top) + at[1]))
        return whole


def _keyframes(file: zipfile.ZipFile, layer: Any) -> list[tuple[int, Any]]:
    """Return the times of a layer's keyframes, each with its XML element."""
    name = layer.get("keyframes")
    if not name:
        return []
    try:
        found = xml_of(file, _path(file, name)).iter("keyframe")
        return sorted(((int(each.get("time")), each) for each in found), key=lambda pair: pair[0])
    except (RefusedError, TypeError, ValueError):
        return []  # the layer's own file is used then


def _path(file: zipfile.ZipFile, name: str) -> str:
    """Return the path of a layer's file in the ZIP, which is in a folder named after the document."""
    ending = f"/layers/{name}"
    return next((each for each in file.namelist() if each.endswith(ending)), ending[1:])


def _tile(packed: bytes, bands: str) -> "Image":
    from PIL import Image

    count = _TILE * _TILE * len(bands)
    if packed[0] == 0:
        return _from_bands(packed[1 : 1 + count], bands, (_TILE, _TILE))
    planes = _unpacked(packed[1:], count)
    side = _TILE * _TILE
    own = [Image.frombytes("L", (_TILE, _TILE), planes[i : i + side]) for i in range(0, count, side)]
    if bands == "L":
        return own[0]
    ordered = (own[2], own[1], own[0], own[3]) if bands == "BGRA" else (own[0], own[0], own[0], own[1])
    return Image.merge("RGBA", ordered)


def _from_bands(data: bytes, bands: str, size: tuple[int, int]) -> "Image":
    from PIL import Image

    if bands == "L":
        return Image.frombytes("L", size, data)
    mode = "RGBA" if bands == "BGRA" else "LA"
    return Image.frombytes(mode, size, data, "raw", bands).convert("RGBA")


def _unpacked(packed: bytes, count: int) -> bytes:
    r"""Return bytes decompressed with LZF.

    Raises:
        ValueError: if their number is not ``count``.

    >>> _unpacked(b"\x01ab\x60\x01", 7)
    b'abababa'
    """
    out, at = bytearray(), 0
    while at < len(packed) and len(out) < count:
        control = packed[at]
        at += 1
        if control < 32:  # a run of control + 1 literal bytes
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
            raise ValueError("a tile refers to data before its start")
        once = bytes(out[len(out) - back : len(out) - back + length])
        out += (once * (length // len(once) + 1))[:length]
    if len(out) != count:
        raise ValueError(f"a tile has {len(out)} bytes instead of {count}")
    return bytes(out)
