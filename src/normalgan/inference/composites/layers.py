"""Layers: read the layers of a file, and write predicted layers as a layered file.

PSD and Aseprite files are written back in their own format. KRA and ORA files are written as ORA, which both
Krita and GIMP open.
"""

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree as Tree

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.decoding import Decoded, DecodedLayer, DecodedLayers, decode_layers
from normalgan.decoding.decoders.formats import detect_format
from normalgan.inference.reading.drawings import LARGEST, SMALLEST, read_content
from normalgan.inference.reading.picture import MOST_WORKED, Picture, fitted, to_picture
from normalgan.inference.regions import box_of

LayeredKind = Literal["psd", "ora", "aseprite"]
"""Formats of layered files that can be written."""
_KINDS: dict[str, LayeredKind] = {"PSD": "psd", "Krita": "ora", "OpenRaster": "ora", "Aseprite": "aseprite"}
_GROUND = (128, 128, 255, 0)
"""A fully transparent flat normal."""
_THUMBNAIL = 256


def layered_kind(path: Path, content: bytes | None = None) -> LayeredKind | None:
    """Return the format that a file's layers are written in; None if the file has no layers.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.
    """
    try:
        with io.BytesIO(content) if content is not None else path.open("rb") as file:
            found = detect_format(file.read(64))
    except OSError:
        return None  # the error is raised when the drawing is read
    return _KINDS.get(found.name) if found is not None else None


def read_layers(path: Path, content: bytes | None = None) -> DecodedLayers:
    """Return the visible layers of a .psd, .kra, .ora, .ase or .aseprite file, bottom to top.

    Hidden layers, adjustment layers and empty layers are left out. Each layer is cropped to its opaque part
    and has a position, an opacity and the names of its groups.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.

    Raises:
        InputError: if the file is missing or too large, or has no visible layer or an unreadable one.
    """
    return decode_layers(str(path), read_content(path, content), (SMALLEST, LARGEST))


def picture_of(layer: DecodedLayer, shape: tuple[int, int]) -> Picture:
    """Return a layer as a drawing (H, W), transparent outside the layer; the layer's opacity is ignored."""
    picture = to_picture(Decoded(_on_canvas(layer, shape), shape))
    if max(shape) <= MOST_WORKED:
        return picture
    return replace(picture.resized(fitted(shape, MOST_WORKED)), full=shape)


def is_plain(layer: DecodedLayer, shape: tuple[int, int]) -> bool:
    """Return whether a layer fills a picture (H, W) with a single colour, like a sheet of paper."""
    return layer.pixels.shape[:2] == shape and bool((layer.pixels == layer.pixels[:1, :1]).all())


def cut(layer: DecodedLayer, pixels: NDArray[np.uint8]) -> DecodedLayer | None:
    """Return a layer with new pixels (H, W, 4), cropped to their opaque part; None if nothing is opaque.

    >>> drawn = np.zeros((8, 8, 4), np.uint8)
    >>> drawn[2:4, 5] = 255
    >>> layer = cut(DecodedLayer("arm", (), 255, 0, 0, 0, 0, drawn), drawn)
    >>> layer.left, layer.top, layer.pixels.shape
    (5, 2, (2, 1, 4))
    """
    opaque = pixels[..., 3] > 0
    if not opaque.any():
        return None
    top, bottom, left, right = box_of(opaque)
    return replace(layer, left=left, top=top, pixels=pixels[top:bottom, left:right].copy())


def encode_layers(
    kind: LayeredKind, shape: tuple[int, int], layers: Sequence[DecodedLayer], durations: Sequence[int] = (0,)
) -> bytes:
    """Return the content of a layered file.

    Args:
        kind: format of the file.
        shape: (H, W) of the picture.
        layers: layers as `read_layers` returns them, frame by frame and bottom to top.
        durations: duration of each frame in milliseconds; only Aseprite files can have more than one frame.
    """
    match kind:
        case "psd":
            return _psd(shape, layers)
        case "ora":
            return _openraster(shape, layers)
        case "aseprite":
            return _aseprite(shape, layers, durations)


def _on_canvas(layer: DecodedLayer, shape: tuple[int, int]) -> NDArray[np.uint8]:
    canvas = np.zeros((*shape, 4), np.uint8)
    height, width = layer.pixels.shape[:2]
    canvas[layer.top : layer.top + height, layer.left : layer.left + width] = layer.pixels
    return canvas


def _merged(shape: tuple[int, int], layers: Sequence[DecodedLayer]) -> Image.Image:
    """Return the composite of all layers."""
    canvas = Image.new("RGBA", shape[::-1], _GROUND)
    for layer in layers:
        image = Image.fromarray(layer.pixels)
        image.putalpha(image.getchannel("A").point([value * layer.opacity // 255 for value in range(256)]))
        canvas.alpha_composite(image, (layer.left, layer.top))
    return canvas


_Node = DecodedLayer | tuple[str, list[DecodedLayer]]


def _nodes(layers: Sequence[DecodedLayer], depth: int) -> Iterator[_Node]:
    """Yield the layers in order, with the layers of each group at ``depth`` as (group name, layers)."""

    def group(layer: DecodedLayer) -> str | None:
        return layer.groups[depth] if len(layer.groups) > depth else None

    for name, inside in groupby(layers, group):
        if name is None:
            yield from inside
        else:
            yield name, list(inside)


def _psd(shape: tuple[int, int], layers: Sequence[DecodedLayer]) -> bytes:
    from psd_tools import PSDImage

    psd: Any = PSDImage.frompil(_merged(shape, layers))

    def add(parent: Any, layers: Sequence[DecodedLayer], depth: int) -> None:
        base = -1
        for node in _nodes(layers, depth):
            if isinstance(node, DecodedLayer):
                image = Image.fromarray(node.pixels)
                own = parent.create_pixel_layer(image, top=node.top, left=node.left, opacity=node.opacity)
                # This sets the Unicode name, and a substitute for the legacy name in Mac Roman.
                own.name = node.name or "Layer"
                # A clipped layer follows its base layer; if the base could not be predicted, it is not
                # clipped.
                own.clipping = node.clipped_to >= 0 and node.clipped_to == base
                base = base if own.clipping else node.number
            else:
                own = parent.create_group()
                own.name = node[0] or "Group"
                add(own, node[1], depth + 1)
                base = -1

    add(psd, layers, 0)
    file = io.BytesIO()
    psd.save(file)
    return file.getvalue()


def _openraster(shape: tuple[int, int], layers: Sequence[DecodedLayer]) -> bytes:
    """Return an ORA; https://www.openraster.org/baseline/file-layout-spec.html."""
    root = Tree.Element("image", {"version": "0.0.3", "w": str(shape[1]), "h": str(shape[0])})
    pictures: list[tuple[str, NDArray[np.uint8]]] = []

    def add(stack: Tree.Element, layers: Sequence[DecodedLayer], depth: int) -> None:
        for node in _nodes(layers, depth):
            if isinstance(node, DecodedLayer):
                name = f"data/layer{len(pictures):03d}.png"
                pictures.append((name, node.pixels))
                about = {"name": _xml_text(node.name), "src": name, "x": str(node.left), "y": str(node.top)}
                each = Tree.Element("layer", about | {"opacity": f"{node.opacity / 255:.4f}"})
            else:
                each = Tree.Element("stack", {"name": _xml_text(node[0])})
                add(each, node[1], depth + 1)
            stack.insert(0, each)  # ORA lists the top layer first

    add(Tree.SubElement(root, "stack"), layers, 0)
    merged = _merged(shape, layers)
    small = merged.copy()
    small.thumbnail((_THUMBNAIL, _THUMBNAIL))
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:  # PNG is already compressed
        every = {
            "mimetype": b"image/openraster",
            "stack.xml": Tree.tostring(root, "utf-8", xml_declaration=True),
            **{name: _png(Image.fromarray(pixels)) for name, pixels in pictures},
            "mergedimage.png": _png(merged),
            "Thumbnails/thumbnail.png": _png(small),
        }
        for name, content in every.items():
            # ZipInfo has a fixed time stamp, so the same drawing gives the same bytes.
            archive.writestr(zipfile.ZipInfo(name), content)
    return file.getvalue()


def _xml_text(text: str) -> str:
    """Return a text with the characters that XML does not allow replaced by U+FFFD."""
    return re.sub(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "\ufffd", text)


def _png(image: Image.Image) -> bytes:
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()


def _aseprite(shape: tuple[int, int], layers: Sequence[DecodedLayer], durations: Sequence[int]) -> bytes:
    """Return an Aseprite file; https://github.com/aseprite/aseprite/blob/main/docs/ase-file-specs.md."""
    # Aseprite has one opacity per layer for all frames, and one per cel that can only lower it.
    first = {layer.number: layer for layer in sorted(layers, key=lambda each: each.opacity)}
    numbers: dict[int, int] = {}
    chunks: list[bytes] = []

    def add(layers: Sequence[DecodedLayer], depth: int) -> None:
        for node in _nodes(layers, depth):
            if isinstance(node, DecodedLayer):
                numbers[node.number] = len(chunks)
                chunks.append(_ase_layer(node.name, 0, depth, node.opacity))
            else:
                chunks.append(_ase_layer(node[0], 1, depth, 255))
                add(node[1], depth + 1)

    add([first[number] for number in sorted(first)], 0)
    body = b""
    for frame, duration in enumerate(durations):
        inside = [] if frame else list(chunks)
        for layer in (each for each in layers if each.frame == frame):
            opacity = first[layer.number].opacity
            own = min(round(255 * layer.opacity / opacity), 255) if opacity else 0
            height, width = layer.pixels.shape[:2]
            head = struct.pack("<HhhBHh5x", numbers[layer.number], layer.left, layer.top, own, 2, 0)
            size = struct.pack("<HH", width, height)
            inside.append(_ase_chunk(0x2005, head + size + zlib.compress(layer.pixels.tobytes())))
        data = b"".join(inside)
        shown = min(max(duration, 1), 2**16 - 1)
        few = min(len(inside), 2**16 - 1)
        body += struct.pack("<IHHH2xI", 16 + len(data), 0xF1FA, few, shown, len(inside)) + data
    head = struct.pack(
        "<IHHHHHIH8xB3xH", 128 + len(body), 0xA5E0, len(durations), *shape[::-1], 32, 1, 100, 0, 0
    )
    return head.ljust(128, b"\0") + body


def _ase_layer(name: str, kind: int, depth: int, opacity: int) -> bytes:
    text = name.encode()
    # Flags 3: visible and editable.
    return _ase_chunk(0x2004, struct.pack("<HHHHHHB3xH", 3, kind, depth, 0, 0, 0, opacity, len(text)) + text)


def _ase_chunk(kind: int, data: bytes) -> bytes:
    return struct.pack("<IH", len(data) + 6, kind) + data
