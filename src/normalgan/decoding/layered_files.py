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
    "KINDS",
    "TREATMENT",
    "Layer",
    "Notes",
    "UnreadableError",
    "aseprite_frames",
    "composite",
    "durations_of",
    "foreign",
    "kind_of",
    "layers",
    "size_of",
]

KINDS = ("PSD", "KRA", "ORA", "Aseprite")
_APPLIED, _NORMAL, _OUT, _NONE = "applied", "shown as normal, named", "left out, named", ""
TREATMENT = {
    "layer opacity": ("kept", "kept", "kept", "kept"),
    "fill opacity": (_APPLIED, _NONE, _NONE, _NONE),
    "layer mask": (_APPLIED, _APPLIED, _NONE, _NONE),
    "group mask": (_APPLIED, _APPLIED, _NONE, _NONE),
    "mask density": (_APPLIED, _NONE, _NONE, _NONE),
    "vector mask": (_APPLIED, _NONE, _NONE, _NONE),
    "clipping": ("applied and kept", _OUT, _OUT, _NONE),
    "stroke and overlay effects": (_APPLIED, _NONE, _NONE, _NONE),
    "shadow, glow, bevel and satin": (_OUT, _OUT, _NONE, _NONE),
    "fill layer": (_APPLIED, _OUT, _NONE, _NONE),
    "shape or vector layer": (_APPLIED, _OUT, _NONE, _NONE),
    "text or smart object": ("its pixels; without them left out, named", _NONE, _NONE, _NONE),
    "adjustment or filter layer": (_OUT, _OUT, _NONE, _NONE),
    "filter, transform or colorize mask": (_NONE, _OUT, _NONE, _NONE),
    "file or clone layer": (_NONE, _OUT, _NONE, _NONE),
    "blend mode": (_NORMAL, _NORMAL, _NORMAL, _NORMAL),
    "animation": (_NONE, "one frame, named", _NONE, "all frames"),
    "tilemap": (_NONE, _NONE, _NONE, "applied; a tileset in another file is left out, named"),
}
"""How each feature of a layer is treated in each of `KINDS`; the documentation has the same table."""

_FOREIGN = {
    b"CSFCHUNK": ("a Clip Studio Paint file", "save it as PSD: File > Save Duplicate > .psd"),
    b"GCPF": ("a Pixelorama project", "export it from Pixelorama as PNG, GIF or APNG"),
    b"gimp xcf": ("a GIMP file", "export it from GIMP as PSD or ORA"),
    b"SAI-CANVAS": ("a PaintTool SAI file", "export it from SAI as PSD"),
    b"mdipack": ("a MediBang file", "export it from MediBang as PSD"),
    b"PDN3": ("a Paint.NET file", "save it from Paint.NET as PNG"),
    b"\0\xffKA": ("an Affinity file", "export it from Affinity as PSD"),
}
"""Files of other paint programs by their first bytes: what they are, and the way out."""
_FOREIGN_ZIPS = {
    "data.json": ("a Pixelorama project", "export it from Pixelorama as PNG, GIF or APNG"),
    "Document.archive": ("a Procreate file", "share it from Procreate as PSD"),
}
"""The same of ZIP files, by a file in them."""

_MOST_FRAMES = 1024
_MOST_MEMBER = 2**29
"""Bytes of one file in a ZIP."""
_MOST_NOTES = 12
"""Notes that are told in full; of more it tells how many."""
_ASEPRITE, _ASEPRITE_FRAME = 0xA5E0, 0xF1FA
_LAYER, _CEL, _PALETTE, _TILESET = 0x2004, 0x2005, 0x2019, 0x2023
_OLD_PALETTES = {0x0004: 255, 0x0011: 63}
"""Aseprite 1.3.5 and later write the first of them alone where no colour is translucent; its brightest."""
_BACKGROUND, _REFERENCE = 8, 64
"""Layers of Aseprite in which no colour is transparent, and those to draw after, which it does not export."""
_GROUP, _TILES = 1, 2
_BLEND_MODES = (
    *("normal", "multiply", "screen", "overlay", "darken", "lighten", "color dodge", "color burn"),
    *("hard light", "soft light", "difference", "exclusion", "hue", "saturation", "color", "luminosity"),
    *("addition", "subtract", "divide"),
)
"""Of Aseprite, by their numbers."""
_TILE = 64
"""Columns and rows of a tile of a Krita layer."""
_KRITA_LAYERS = {
    "adjustmentlayer": "filter layer",
    "generatorlayer": "fill layer",
    "shapelayer": "vector layer",
    "filelayer": "file layer",
    "clonelayer": "clone layer",
}
"""Layers of Krita that hold no pixels of their own, by what Krita calls them in its files."""
_KRITA_MASKS = {
    "filtermask": "filter mask",
    "transformmask": "transform mask",
    "colorizemask": "colorize mask",
}
_ANIMATED = "it is animated in Krita, of which"
_WAY_OUT = "is used; render the animation as GIF, WebP or PNG files for all frames"
_DRAWN_EFFECTS = {"stroke", "coloroverlay", "gradientoverlay", "patternoverlay"}
"""Effects of Photoshop that psd-tools draws, by the names of its classes."""
_STROKE = 250
"""Pixels by which the widest stroke of Photoshop reaches beyond its layer."""


class UnreadableError(Exception):
    """A layered file that cannot be read; its text goes after the file's name."""


class Notes:
    """What is to be said of a layered file: what of it is not shown as its program shows it."""

    def __init__(self) -> None:
        self._said: dict[str, None] = {}
        self.partial = False
        """Whether a layer is missing, and not only a part of how it is shown."""

    def leave_out(self, name: str, words: str) -> None:
        """Note a layer that is missing."""
        self.partial = True
        self.add(name, words)

    def add(self, name: str, words: str) -> None:
        """Note something of a layer."""
        self._said[f"{name!r}: {words}"] = None

    def add_blend(self, name: str, mode: str) -> None:
        """Note a blend mode that is not shown."""
        self.add(name, f"blend mode {mode.replace('_', ' ').lower()} shown as normal")

    def add_file(self, words: str) -> None:
        """Note something of the whole file."""
        self._said[words] = None

    def __str__(self) -> str:
        said = list(self._said)
        more = f"; and {len(said) - _MOST_NOTES} more" if len(said) > _MOST_NOTES else ""
        return "; ".join(said[:_MOST_NOTES]) + more


@dataclass(eq=False)
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
        base: the layer that it is clipped to, by which the image is cut.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    left: int
    top: int
    image: "Image"
    number: int = 0
    frame: int = 0
    base: "Layer | None" = None


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


def foreign(content: bytes) -> str | None:
    """Return what a file of a paint program is that cannot be read, and the way out; None of any other.

    >>> foreign(b"gimp xcf v011")
    'is a GIMP file, which cannot be read; export it from GIMP as PSD or ORA'
    """
    found = next((words for start, words in _FOREIGN.items() if content.startswith(start)), None)
    return None if found is None else f"is {found[0]}, which cannot be read; {found[1]}"


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
            with _zip(content) as file:
                return _zip_size(file)


def composite(content: bytes, notes: Notes) -> "Image":
    """Return what a layered file shows; of an Aseprite file its first frame.

    Args:
        content: of the file.
        notes: takes what is not shown as its program shows it.

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
            return next(aseprite_frames(content, notes))[0]
        case _:
            with _zip(content) as file:
                if "mergedimage.png" not in file.namelist():  # MyPaint leaves it out
                    return _flattened(_zip_size(file), _zip_layers(content, notes))
                krita = "maindoc.xml" in file.namelist()
                if krita and _krita_moment(file, _xml(file, "maindoc.xml")) is not None:
                    notes.add_file(f"{_ANIMATED} the picture that Krita merged when it was saved {_WAY_OUT}")
                return _png(_member(file, "mergedimage.png"))


def aseprite_frames(content: bytes, notes: Notes) -> "Iterator[tuple[Image, int]]":
    """Yield the frames of an Aseprite file, and how many milliseconds each is shown."""
    file = _Aseprite(content, notes)
    for number, duration in enumerate(file.durations):
        shown = _flattened(file.size, iter(file.cels(number)))
        if not number and file.broken and not file.drawn:
            raise UnreadableError(file.broken)
        yield shown, duration


def _flattened(size: tuple[int, int], found: Iterator[Layer]) -> "Image":
    """Return what layers show together, the lowest first."""
    from PIL import Image

    canvas = Image.new("RGBA", size)
    for layer in found:
        over = Image.new("RGBA", size)
        over.paste(_faded(layer.image, layer.opacity), (layer.left, layer.top))
        canvas = Image.alpha_composite(canvas, over)
    return canvas


def durations_of(content: bytes) -> list[int]:
    """Return how many milliseconds each frame is shown; one frame of none of what does not move."""
    return _Aseprite(content, Notes()).durations if kind_of(content) == "aseprite" else [0]


def layers(content: bytes, notes: Notes) -> Iterator[Layer]:
    """Yield the visible layers that something is drawn on, the lowest first, cut to what is opaque in them.

    Those of an Aseprite file come frame by frame. A layer that cannot be shown is left out and noted.

    Args:
        content: of the file.
        notes: takes what is not shown as its program shows it.

    Raises:
        UnreadableError: if the file cannot be read.
    """
    width, height = size_of(content)
    match kind_of(content):
        case "psd":
            found = _psd_layers(content, notes)
        case "aseprite":
            file = _Aseprite(content, notes)
            found = (cel for frame in range(len(file.durations)) for cel in file.cels(frame))
        case _:
            found = _zip_layers(content, notes)
    for number, each in enumerate(found):
        if kind_of(content) != "aseprite":
            each.number = number
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
        yield each


def _psd_layers(content: bytes, notes: Notes) -> Iterator[Layer]:
    psd = _psd(content)
    if psd.color_mode.name not in {"RGB", "GRAYSCALE"}:
        raise UnreadableError(
            f"has its colours in {psd.color_mode.name}; layers of RGB and of greys can be painted"
        )
    return _psd_group(psd, psd, (), 255, notes)


def _psd_group(psd: Any, group: Any, chain: tuple[Any, ...], opacity: int, notes: Notes) -> Iterator[Layer]:
    """Yield the layers of a group; ``chain`` is the group and those that it lies in, the outermost first."""
    base: Layer | None = None
    hidden = False
    for layer in group:
        clipped = bool(layer.clipping)
        if not clipped:
            base, hidden = None, not layer.visible
        if not layer.visible or (clipped and hidden):  # with its base all that is clipped to it is hidden
            continue
        own = opacity * layer.opacity // 255
        if layer.blend_mode.name not in {"NORMAL", "PASS_THROUGH"}:
            notes.add_blend(layer.name, layer.blend_mode.name)
        if layer.is_group():
            _drawn_effects(layer, notes)
            if clipped:
                notes.add(layer.name, "clipping of a group left out")
            yield from _psd_group(psd, layer, (*chain, layer), own, notes)
            continue
        found = _psd_layer(psd, layer, chain, own, notes)
        if found is None:
            continue
        if clipped:
            if base is None:
                notes.add(layer.name, "clipping to a group left out")
            else:
                found.base = base
                _cut(found, base)
        else:
            base = found
        yield found


def _psd_layer(psd: Any, layer: Any, chain: tuple[Any, ...], opacity: int, notes: Notes) -> Layer | None:
    """Return a layer of a PSD as psd-tools shows it alone; None if it shows nothing."""
    from psd_tools.constants import Tag

    name, groups, kind = layer.name, tuple(each.name for each in chain), layer.kind
    effects = _drawn_effects(layer, notes)
    fills = kind == "shape" or kind.endswith("fill")
    if not fills and not layer.has_pixels():
        if kind in {"type", "smartobject"}:
            noun = "text" if kind == "type" else "smart object"
            notes.leave_out(name, f"{noun} without pixels left out; rasterize it")
        elif kind != "pixel":
            notes.add(name, f"adjustment layer ({kind}) left out")
        return None
    if not effects:  # with effects psd-tools fades the layer, and not its effects
        opacity = opacity * layer.tagged_blocks.get_data(Tag.BLEND_FILL_OPACITY, 255) // 255
    masked = any(_has_mask(each) for each in (*chain, layer))
    if not (fills or effects or masked):
        return Layer(name, groups, opacity, layer.left, layer.top, layer.topil().convert("RGBA"))
    reach = _STROKE if "stroke" in effects else 0
    box = (
        (0, 0, psd.width, psd.height)
        if fills and not layer.has_pixels()
        else (
            max(layer.left - reach, 0),
            max(layer.top - reach, 0),
            min(layer.right + reach, psd.width),
            min(layer.bottom + reach, psd.height),
        )
    )
    if box[2] <= box[0] or box[3] <= box[1]:
        return None
    try:
        return Layer(name, groups, opacity, box[0], box[1], _psd_alone(psd, layer, chain, box))
    except ImportError:  # psd-tools draws the outline of a shape by a library that is not needed elsewhere
        notes.add(name, "outline of a shape left out; rasterize it")
        image = layer.topil() if layer.has_pixels() else None
    except MemoryError:
        raise
    except Exception as error:  # a library that trips over damage raises anything
        notes.leave_out(name, f"cannot be read: {error}; left out")
        return None
    return None if image is None else Layer(name, groups, opacity, layer.left, layer.top, image)


def _psd_alone(psd: Any, layer: Any, chain: tuple[Any, ...], box: tuple[int, int, int, int]) -> "Image":
    """Return a layer with its masks, those of its groups and its effects, without opacity, RGBA."""
    import numpy as np
    from PIL import Image
    from psd_tools.composite import composite as render

    shown = {id(each) for each in (*chain, layer)}
    layer.clipping = False  # else psd-tools shows it with its base alone
    # A vector mask beside a mask that Photoshop drew from it counts once.
    color, shape, _ = render(psd, 0.0, 0.0, box, lambda each: id(each) in shown and each.visible)
    color = np.repeat(color, 3, -1) if color.shape[-1] == 1 else color
    levels = np.clip(np.rint(255 * np.dstack([color[..., :3], shape])), 0, 255)
    return Image.fromarray(levels.astype(np.uint8))


def _drawn_effects(layer: Any, notes: Notes) -> set[str]:
    """Return the effects of a layer that psd-tools draws; note the others."""
    if not layer.has_effects() or not layer.effects.enabled:
        return set()
    found = {type(each).__name__: each for each in layer.effects if each.enabled}
    for name in found:
        if name.lower() not in _DRAWN_EFFECTS:
            words = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()
            notes.add(layer.name, f"{words} left out")
    return {name.lower() for name in found} & _DRAWN_EFFECTS


def _has_mask(layer: Any) -> bool:
    mask, path = layer.mask, layer.vector_mask
    return (
        (mask is not None and not mask.disabled)
        or (path is not None and not path.disabled)
        or layer.kind == "artboard"
    )


def _cut(layer: Layer, base: Layer) -> None:
    """Multiply the opacity of a layer's picture by that of its base's."""
    from PIL import Image, ImageChops

    whole = Image.new("L", layer.image.size)
    whole.paste(base.image.getchannel("A"), (base.left - layer.left, base.top - layer.top))
    layer.image.putalpha(ImageChops.multiply(layer.image.getchannel("A"), whole))


def _xml(file: zipfile.ZipFile, name: str) -> Any:
    from xml.etree import ElementTree as Tree

    try:
        root = Tree.fromstring(_member(file, name))
    except Tree.ParseError as error:
        raise UnreadableError(f"has a broken {name}: {error}") from None
    for each in root.iter():
        each.tag = each.tag.rpartition("}")[2]
    return root


def _zip_size(file: zipfile.ZipFile) -> tuple[int, int]:
    """Return (width, height) of an OpenRaster or a Krita file."""
    names = file.namelist()
    if "mergedimage.png" in names:
        return _png(_member(file, "mergedimage.png")).size
    for name, words in _FOREIGN_ZIPS.items():
        if name in names:
            raise UnreadableError(f"is {words[0]}, which cannot be read; {words[1]}")
    if "maindoc.xml" in names:
        about, keys = _xml(file, "maindoc.xml").find("IMAGE"), ("width", "height")
    elif "stack.xml" in names:
        about, keys = _xml(file, "stack.xml"), ("w", "h")
    else:
        raise UnreadableError("is a ZIP without mergedimage.png; OpenRaster and Krita files have one")
    try:
        return int(about.get(keys[0])), int(about.get(keys[1]))
    except (AttributeError, TypeError, ValueError):
        raise UnreadableError("does not say how large it is") from None


def _zip_layers(content: bytes, notes: Notes) -> Iterator[Layer]:
    with _zip(content) as file:
        size = _zip_size(file)
        if "maindoc.xml" in file.namelist():
            root = _xml(file, "maindoc.xml")
            moment = _krita_moment(file, root)
            if moment is not None:
                notes.add_file(f"{_ANIMATED} the frame {moment}, at which it was saved, {_WAY_OUT}")
            yield from _Krita(file, size, moment or 0, notes).layers(root.find("IMAGE/layers"), (), 255, ())
        else:
            root = _xml(file, "stack.xml")
            yield from _openraster_layers(file, root.find("stack"), (), 1.0, notes)


def _openraster_layers(
    file: zipfile.ZipFile, stack: Any, path: tuple[str, ...], opacity: float, notes: Notes
) -> Iterator[Layer]:
    """Yield the layers of a stack; https://www.openraster.org/baseline/layer-stack-spec.html."""
    for each in reversed(stack if stack is not None else ()):
        name = each.get("name", "")
        if each.get("visibility") == "hidden":
            continue
        mode = each.get("composite-op", "svg:src-over").rpartition(":")[2]
        if mode == "src-atop":
            notes.add(name, "clipping left out")
        elif mode != "src-over":
            notes.add_blend(name, mode)
        try:
            own = opacity * min(max(float(each.get("opacity", "1")), 0.0), 1.0)
            left, top = int(each.get("x", "0")), int(each.get("y", "0"))
            image = _png(_member(file, each.get("src", ""))) if each.tag == "layer" else None
            if image is not None:
                image.load()
        except (ValueError, OSError, SyntaxError, UnreadableError) as error:
            notes.leave_out(name, f"cannot be read: {error}; left out")
            continue
        if each.tag == "stack":
            yield from _openraster_layers(file, each, (*path, name), own, notes)
        elif image is not None:
            yield Layer(name, path, round(255 * own), left, top, image)


def _krita_moment(file: zipfile.ZipFile, root: Any) -> int | None:
    """Return the time at which an animated Krita file was saved; None of one that does not move."""
    times = {time for each in root.iter("layer") for time, _ in _keyframes(file, each)}
    if len(times) < 2:
        return None
    current = root.find("IMAGE/animation/currentTime")
    try:
        return int(current.get("value")) if current is not None else 0
    except (TypeError, ValueError):
        return 0


def _keyframes(file: zipfile.ZipFile, layer: Any) -> list[tuple[int, Any]]:
    """Return the times of a layer's frames, and what describes each."""
    name = layer.get("keyframes")
    if not name:
        return []
    try:
        found = _xml(file, _krita_path(file, name)).iter("keyframe")
        return sorted(((int(each.get("time")), each) for each in found), key=lambda pair: pair[0])
    except (UnreadableError, TypeError, ValueError):
        return []  # then the layer's own file shows it


def _krita_path(file: zipfile.ZipFile, name: str) -> str:
    """Return the name in the ZIP of a file of a layer; it lies in a folder named after the document."""
    ending = f"/layers/{name}"
    return next((each for each in file.namelist() if each.endswith(ending)), ending[1:])


class _Krita:
    """The layers of a Krita file.

    Args:
        file: the ZIP.
        size: (width, height) of the picture.
        moment: the time of an animation whose frame is read.
        notes: takes what is not shown as Krita shows it.
    """

    def __init__(self, file: zipfile.ZipFile, size: tuple[int, int], moment: int, notes: Notes) -> None:
        self._file, self._size, self._moment, self._notes = file, size, moment, notes

    def layers(
        self, group: Any, path: tuple[str, ...], opacity: int, masks: "tuple[Image, ...]"
    ) -> Iterator[Layer]:
        """Yield the layers of a group, the lowest first; ``masks`` are those of its groups."""
        from PIL import ImageChops

        for each in reversed(group if group is not None else ()):
            name, kind = each.get("name", ""), each.get("nodetype", "")
            if each.get("visible", "1") == "0":
                continue
            if kind not in {"grouplayer", "paintlayer"}:
                note = self._notes.add if kind == "adjustmentlayer" else self._notes.leave_out
                note(name, f"{_KRITA_LAYERS.get(kind, f'layer of the kind {kind}')} left out")
                continue
            self._note(each, name)
            try:
                own = opacity * min(max(int(each.get("opacity", "255")), 0), 255) // 255
                inside = (*masks, *self._masks(each, name))
                if kind == "grouplayer":
                    yield from self.layers(each.find("layers"), (*path, name), own, inside)
                    continue
                image = self._paint(each)
            except (ValueError, IndexError, UnreadableError) as error:
                self._notes.leave_out(name, f"cannot be read: {error}; left out")
                continue
            for mask in inside:
                image.putalpha(ImageChops.multiply(image.getchannel("A"), mask))
            yield Layer(name, path, own, 0, 0, image)

    def _note(self, layer: Any, name: str) -> None:
        mode = layer.get("compositeop", "normal")
        if mode not in {"normal", "passthrough"}:
            self._notes.add_blend(name, mode)
        if layer.get("channelflags", "").endswith("0"):
            self._notes.add(name, "clipping (inherit alpha) left out")
        if layer.get("layerstyle"):
            self._notes.add(name, "layer style left out")

    def _masks(self, layer: Any, name: str) -> "list[Image]":
        """Return the transparency masks of a layer, each as large as the whole; note the others."""
        found = []
        for each in layer.findall("masks/mask"):
            kind = each.get("nodetype", "")
            if each.get("visible") == "0":
                continue
            if kind == "transparencymask":
                at = int(each.get("x", "0")), int(each.get("y", "0"))
                found.append(self._pixels(f"{each.get('filename', '')}.pixelselection", at, "L"))
            elif kind in _KRITA_MASKS:
                self._notes.add(name, f"{_KRITA_MASKS[kind]} left out")
        return found

    def _paint(self, layer: Any) -> "Image":
        """Return the picture of a paint layer, as large as the whole."""
        space = layer.get("colorspacename", "RGBA")
        bands = {"RGBA": "BGRA", "GRAYA": "LA"}.get(space)
        if bands is None:
            raise ValueError(f"it has its colours in {space}, and not in 8 bits of RGBA or GRAYA")
        name, at = layer.get("filename", ""), (int(layer.get("x", "0")), int(layer.get("y", "0")))
        shown = [each for time, each in _keyframes(self._file, layer) if time <= self._moment]
        if shown:
            offset = shown[-1].find("offset")
            name = shown[-1].get("frame", name)
            if offset is not None:
                at = at[0] + int(offset.get("x", "0")), at[1] + int(offset.get("y", "0"))
        return self._pixels(name, at, bands)

    def _pixels(self, filename: str, at: tuple[int, int], bands: str) -> "Image":
        """Return what a file of tiles holds, as large as the whole.

        The format is that of Krita's ``KisTiledDataManager`` and ``KisTileCompressor2``: lines of text, and
        then tiles, each with a line that says where it lies, and its bytes, one plane after the other, packed
        by LZF.

        Raises:
            ValueError: if it is broken, and so is `IndexError`.
        """
        file = self._file
        name = _krita_path(file, filename)
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
        whole = _from_bands(ground, bands, (1, 1)).resize(self._size)
        for _ in range(about["DATA"]):
            left, top, packing, count = (
                data[here : (end := data.index(b"\n", here))].decode("ascii").split(",")
            )
            here = end + 1 + int(count)
            if packing != "LZF" or here > len(data):
                raise ValueError("a tile of it is packed in a way that is not known, or ends too early")
            whole.paste(_tile(data[end + 1 : here], bands), (int(left) + at[0], int(top) + at[1]))
        return whole


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
        about = file.getinfo(_stored_name(file, name))
        if about.file_size > _MOST_MEMBER:
            raise UnreadableError(f"has more than {_MOST_MEMBER} bytes in its {name}")
        with file.open(about) as member:
            return member.read(_MOST_MEMBER)
    except KeyError:
        raise UnreadableError(f"is a ZIP without {name}; OpenRaster and Krita files have one") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise UnreadableError(f"is broken: {error}") from None


def _stored_name(file: zipfile.ZipFile, name: str) -> str:
    """Return a name as the ZIP has it: without the flag for Unicode, UTF-8 is taken for the old code page."""
    if name in file.NameToInfo:
        return name
    return name.encode("utf-8", "replace").decode("cp437")


def _png(data: bytes) -> "Image":
    from PIL import Image

    return Image.open(io.BytesIO(data), formats=("PNG",))


@dataclass(frozen=True)
class _Tileset:
    """The tiles of a tilemap.

    Args:
        size: (width, height) of a tile.
        count: of the tiles.
        pixels: of all, one below the other; None if they lie in another file.
        zero_is_empty: whether the tile 0 shows nothing.
    """

    size: tuple[int, int]
    count: int
    pixels: bytes | None
    zero_is_empty: bool


@dataclass(frozen=True)
class _AsepriteLayer:
    """What an Aseprite file says of a layer.

    Args:
        name: of the layer.
        groups: names of those that it lies in.
        opacity: with that of its groups.
        visible: whether it is shown, and no group.
        opaque: whether no colour is transparent in it.
        tileset: number of its tileset; None if it is not of tiles.
    """

    name: str
    groups: tuple[str, ...]
    opacity: int
    visible: bool
    opaque: bool
    tileset: int | None


class _Aseprite:
    """An Aseprite file: https://github.com/aseprite/aseprite/blob/main/docs/ase-file-specs.md.

    Args:
        content: of the file.
        notes: takes what is not shown as Aseprite shows it.
    """

    def __init__(self, content: bytes, notes: Notes) -> None:
        self.size = size_of(content)
        self.broken, self.drawn = "", False
        self._notes = notes
        frames, self._depth, self._flags, self._clear, colours = struct.unpack(
            "<6xH4xHI10xB3xH", content[:34]
        )
        if not 0 < frames <= _MOST_FRAMES:
            raise UnreadableError(f"has {frames} frames; 1 to {_MOST_FRAMES} can be read")
        self.durations: list[int] = []
        self._layers: list[_AsepriteLayer] = []
        self._levels: list[tuple[bool, str, int]] = []
        self._tilesets: dict[int, _Tileset] = {}
        # An index outside the palette is transparent; old files do not say how many colours it has.
        self._palette = [(0, 0, 0, 255)] * (colours or 256)
        self._palettes: list[list[tuple[int, int, int, int]]] = []
        self._old_palette = True
        self._cels: list[dict[int, bytes]] = []
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
                self._palettes.append(list(self._palette))
                at += length
        except (struct.error, IndexError) as error:
            raise UnreadableError(f"is a broken Aseprite file: {error}") from None

    def cels(self, frame: int) -> list[Layer]:
        """Return what the visible layers show in a frame, the lowest first."""
        found = []
        for number, layer in enumerate(self._layers):
            if not layer.visible or number not in self._cels[frame]:
                continue
            try:
                shown = self._cel(number, frame)
                (raised,) = struct.unpack_from("<h", self._cels[frame][number], 9)
            except (struct.error, ValueError, zlib.error, KeyError, IndexError) as error:
                self._notes.leave_out(layer.name, f"cannot be read in frame {frame + 1}: {error}; left out")
                self.broken = self.broken or f"has a broken layer {layer.name!r}: {error}"
                continue
            if shown is None:
                continue
            left, top, own, image = shown
            cel = Layer(layer.name, layer.groups, layer.opacity * own // 255, left, top, image, number, frame)
            found.append((number + raised, raised, cel))
            self.drawn = True
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
        # The second flag of the header says that groups have an opacity, the first that layers have one.
        opacity = opacity if self._flags & (2 if what == _GROUP else 1) else 255
        opacity = opacity * (above[-1][2] if above else 255) // 255
        self._levels[level:] = [(visible, name, opacity)]
        if visible and blend and (what != _GROUP or self._flags & 2):
            self._notes.add_blend(name, _BLEND_MODES[blend] if blend < len(_BLEND_MODES) else str(blend))
        self._layers.append(
            _AsepriteLayer(
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
        if not 0 <= count * width * height <= 2**26:
            raise UnreadableError(f"has a tileset of {count} tiles of {width} × {height} pixels")
        if flags & 1:  # numbers of the other file and of its tileset
            at += 8
        if flags & 2:
            pixels = zlib.decompressobj().decompress(data[at + 4 :], size) if size else b""
        self._tilesets[number] = _Tileset((width, height), count, pixels, bool(flags & 4))

    def _set(self, index: int, colour: tuple[int, int, int, int]) -> None:
        self._palette += [(0, 0, 0, 255)] * (index + 1 - len(self._palette))
        self._palette[index] = colour

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
                self._set(min(index, 255), (red, green, blue, 255))
                at, index = at + 3, index + 1

    def _cel(self, number: int, frame: int) -> "tuple[int, int, int, Image] | None":
        """Return left, top, opacity and picture of what a layer shows in a frame; None of nothing."""
        data = self._cels[frame][number]
        left, top, own, kind = struct.unpack_from("<2xhhBH", data)
        if kind == 1:  # as in an earlier frame; nothing, if that has no such cel
            (other,) = struct.unpack_from("<H", data, 16)
            return self._cel(number, other) if other < frame and number in self._cels[other] else None
        if kind == 3:
            image = self._tilemap(number, frame, data)
            return None if image is None else (left, top, own, image)
        if kind not in {0, 2}:
            raise ValueError(f"it is of the unknown kind {kind}")
        width, height = struct.unpack_from("<HH", data, 16)
        if not 0 < width * height <= 2**26:
            raise ValueError(f"it has {width} × {height} pixels")
        count = width * height * self._depth // 8
        pixels = data[20:] if kind == 0 else zlib.decompressobj().decompress(data[20:], count)
        return left, top, own, self._image(pixels, (width, height), number, frame)

    def _image(self, pixels: bytes, size: tuple[int, int], number: int, frame: int) -> "Image":
        """Return pixels as a picture in RGBA."""
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
        """Return the picture of a cel of tiles; None if its tileset lies in another file."""
        from PIL import Image

        columns, rows, bits, numbers, *flips = struct.unpack_from("<HHHIIII", data, 16)
        layer = self._layers[number]
        tileset = self._tilesets.get(-1 if layer.tileset is None else layer.tileset)
        if tileset is None or tileset.pixels is None:
            self._notes.leave_out(layer.name, "tileset in another file left out; convert it to a layer")
            return None
        width, height = tileset.size
        if bits not in {8, 16, 32} or not 0 < columns * width * rows * height <= 2**26:
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
            # In this order: a tile that is turned by a quarter is mirrored along its diagonal and flipped.
            for flip, how in zip(reversed(flips), _FLIPS, strict=True):
                part = part.transpose(Image.Transpose(how)) if tile & flip else part
            image.paste(part, (place % columns * width, place // columns * height))
        return image


_FLIPS = (5, 1, 0)
"""Of Pillow: along the diagonal, top to bottom, left to right."""
