"""Atlas formats: parsers for the files that list the positions of a sheet's sprites."""

import json
import math
import plistlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, NamedTuple
from xml.etree import ElementTree as Tree
from xml.parsers.expat import ExpatError


class UnreadableAtlasError(Exception):
    """An atlas that cannot be read; the message continues a sentence that begins with the atlas's name."""


@dataclass(frozen=True)
class Frame:
    """The position of a sprite in its sheet, in the units of the atlas.

    Args:
        name: name of the sprite in the atlas.
        left: first column.
        top: first row.
        width: columns in the sheet.
        height: rows in the sheet.
        turned: rotation of the sprite, in clockwise quarter turns.
    """

    name: str
    left: float
    top: float
    width: float
    height: float
    turned: int = 0


@dataclass(frozen=True)
class Page:
    """The entries of an atlas for one sheet.

    Args:
        image: file name of the sheet without its folder; empty if the atlas does not name it.
        size: (width, height) of the sheet; None if the atlas does not give it.
        frames: name and position of each sprite; the position is None if the atlas gives none.
        from_below: whether ``top`` of the frames is the distance from the sheet's lower edge to that of the
            sprite, because the atlas measures from there and does not give the sheet's size.
    """

    image: str
    size: tuple[float, float] | None
    frames: list[tuple[str, Frame | None]]
    from_below: bool = False


class Format(NamedTuple):
    """A file format of atlases.

    Args:
        name: name of the format in messages.
        endings: file endings of the format.
        parse: returns the pages of a text, or None if the text is in another format.
    """

    name: str
    endings: tuple[str, ...]
    parse: Callable[[str], list[Page] | None]


_NUMBER = r"\s*(-?\d+(?:\.\d+)?)"
_QUARTER = 90


def parse_atlas(content: bytes) -> list[Page]:
    """Return the pages of an atlas in any format of `FORMATS`.

    Args:
        content: content of the atlas file.

    Raises:
        UnreadableAtlasError: if the file is broken or in an unknown format.
    """
    text = _text(content)
    for each in FORMATS:
        pages = each.parse(text)
        if pages is not None:
            return pages
    known = ", ".join(each.name for each in FORMATS)
    raise UnreadableAtlasError(f"{_looks_like(content, text)}; supported atlas formats are {known}")


def _text(content: bytes) -> str:
    if content.startswith(b"bplist00"):
        try:
            return plistlib.dumps(plistlib.loads(content)).decode()
        except (ValueError, OverflowError, IndexError, RecursionError) as error:
            raise UnreadableAtlasError(f"is a broken property list: {error}") from None
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return content.decode("utf-16", "replace")
    return content.decode("utf-8-sig", "replace")


def _number(value: Any) -> float | None:
    """Return a JSON value as a number, or None; some programs write numbers as strings."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        found = float(value)
    except (ValueError, OverflowError):
        return None
    return found if math.isfinite(found) else None


def _frame(name: str, box: list[Any], turned: int = 0, upright: bool = False) -> tuple[str, Frame | None]:
    """Return a named frame from left, top, width and height; ``upright`` sizes are those before rotation."""
    left, top, width, height = [_number(each) for each in box] if len(box) == 4 else [None] * 4
    if left is None or top is None or width is None or height is None or min(width, height) < 0:
        return name, None
    if upright and turned % 2:
        width, height = height, width
    return name, Frame(name, left, top, width, height, turned % 4)


def _size(width: Any, height: Any) -> tuple[float, float] | None:
    across, down = _number(width), _number(height)
    return (across, down) if across and down else None


def _name(image: Any) -> str:
    """Return the file name of a sheet without its folder."""
    return PurePosixPath(image.replace("\\", "/")).name if isinstance(image, str) else ""


def _quarters(rotated: Any, clockwise: bool = True) -> int:
    """Return the clockwise quarter turns that an atlas entry's rotation stands for."""
    if isinstance(rotated, str):
        rotated = {"true": True, "y": True, "yes": True}.get(rotated.strip().lower(), rotated)
    degrees = _QUARTER if rotated is True else _number(rotated) or 0
    quarters = round(degrees / _QUARTER)
    return (quarters if clockwise else -quarters) % 4


def _json(text: str) -> list[Page] | None:
    """Parse TexturePacker's JSON (hash, array or multi-pack) and similar formats."""
    if not text.lstrip().startswith(("{", "[")) or re.match(r"\s*\[gd_", text):
        return None
    try:
        content = json.loads(text)
    except RecursionError:
        raise UnreadableAtlasError("is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise UnreadableAtlasError(
            f"is broken JSON: line {error.lineno}, column {error.colno} is a syntax error"
        ) from None
    if isinstance(content, list):
        content = {"frames": content}
    textures = content.get("textures")
    if isinstance(textures, list):  # the key is "frames" in Phaser, "sprites" in Godot
        return [_json_page(each) for each in textures if isinstance(each, dict)]
    if isinstance(content.get("images"), list):
        if not isinstance(content.get("frames"), list):
            raise UnreadableAtlasError("divides its sheet evenly; use --sheet instead")
        return _easel(content["images"], content["frames"])
    if any(isinstance(content.get(each), dict | list) for each in ("frames", "SubTexture")):
        return [_json_page(content)]
    return None


def _json_page(content: dict[str, Any]) -> Page:
    meta = content.get("meta")
    about: dict[str, Any] = meta if isinstance(meta, dict) else content
    image = next((about[key] for key in ("image", "imagePath", "file") if key in about), "")
    size = about.get("size")
    given = _size(size.get("w"), size.get("h")) if isinstance(size, dict) else None
    if given is None and "SubTexture" in content:  # DragonBones
        given = _size(content.get("width"), content.get("height"))
    frames: Any = next((content[key] for key in ("frames", "sprites", "SubTexture") if key in content), [])
    named = frames.items() if isinstance(frames, dict) else enumerate(frames, 1)
    return Page(_name(image), given, [_json_frame(str(key), each) for key, each in named])


def _json_frame(name: str, entry: Any) -> tuple[str, Frame | None]:
    if not isinstance(entry, dict):
        return name, None
    name = str(next((entry[key] for key in ("filename", "name") if key in entry), name))
    box = next((entry[key] for key in ("frame", "region") if isinstance(entry.get(key), dict)), entry)
    sides = [[box.get(short, box.get(long))] for short, long in (("w", "width"), ("h", "height"))]
    found = [box.get("x"), box.get("y"), *sides[0], *sides[1]]
    # TexturePacker and Aseprite give the size before rotation.
    return _frame(name, found, _quarters(entry.get("rotated")), upright=True)


def _easel(images: list[Any], frames: list[Any]) -> list[Page]:
    """Return the pages of an EaselJS file, whose frames are lists: x, y, width, height, image index."""
    pages = [Page(_name(each), None, []) for each in images]
    for number, each in enumerate(frames, 1):
        box = each if isinstance(each, list) else []
        place = box[4] if len(box) > 4 and isinstance(box[4], int) else 0
        if 0 <= place < len(pages):
            pages[place].frames.append(_frame(str(number), box[:4]))
    return pages


def _xml(text: str) -> list[Page] | None:
    """Parse the XML of Starling and Sparrow (SubTexture) and TexturePacker's generic XML (sprite)."""
    if "<TextureAtlas" not in text:
        return None
    if "<!ENTITY" in text:
        raise UnreadableAtlasError("declares entities, which are not supported")
    try:
        root = Tree.fromstring(text.lstrip())
    except (Tree.ParseError, ValueError) as error:
        raise UnreadableAtlasError(f"is broken XML: {error}") from None
    pages = []
    for atlas in root.iter("TextureAtlas"):
        frames: list[tuple[str, Frame | None]] = []
        for number, each in enumerate(atlas, 1):
            long = each.tag == "SubTexture"
            keys = ("x", "y", "width", "height") if long else ("x", "y", "w", "h")
            name = each.get("name" if long else "n", str(number))
            # Both formats give the size of the sprite as it lies in the sheet.
            turned = _quarters(each.get("rotated" if long else "r"))
            frames.append(_frame(name, [each.get(key) for key in keys], turned))
        size = _size(atlas.get("width"), atlas.get("height"))
        pages.append(Page(_name(atlas.get("imagePath")), size, frames))
    return pages


def _plist(text: str) -> list[Page] | None:
    """Parse a Cocos2d property list (formats 0 to 3)."""
    if "<plist" not in text:
        return None
    try:
        content = plistlib.loads(text.lstrip().encode())
    except (plistlib.InvalidFileException, ExpatError, ValueError, IndexError, RecursionError) as error:
        raise UnreadableAtlasError(f"is a broken property list: {error}") from None
    frames = content.get("frames") if isinstance(content, dict) else None
    if not isinstance(frames, dict):
        return None
    found = content.get("metadata")
    about: dict[str, Any] = found if isinstance(found, dict) else {}
    image = about.get("realTextureFileName") or about.get("textureFileName") or ""
    size = re.findall(_NUMBER, str(about.get("size", "")))
    return [
        Page(
            _name(image),
            _size(*size) if len(size) == 2 else None,
            [_plist_frame(str(name), each) for name, each in frames.items()],
        )
    ]


def _plist_frame(name: str, entry: Any) -> tuple[str, Frame | None]:
    if not isinstance(entry, dict):
        return name, None
    box = entry.get("textureRect", entry.get("frame"))
    if box is None:
        return _frame(name, [entry.get(key) for key in ("x", "y", "width", "height")])
    turned = _quarters(entry.get("textureRotated", entry.get("rotated")))
    return _frame(name, re.findall(_NUMBER, str(box)), turned, upright=True)


_GDX = re.compile(r"^\s*([a-z]+)\s*:\s*(.*?)\s*$", re.MULTILINE)


def _gdx(text: str) -> list[Page] | None:
    """Parse the text format of libGDX and Spine.

    A page starts with the sheet's name and a region with the region's name. The lines with a colon that
    follow are their attributes. An empty line ends a page. Source:
    https://esotericsoftware.com/spine-atlas-format.
    """
    keys = {match[1] for match in _GDX.finditer(text)}
    if "bounds" not in keys and not {"xy", "size"} <= keys:
        return None
    pages: list[Page] = []
    for block in re.split(r"\n[ \t]*\n", text.replace("\r", "")):
        lines = [line for line in block.splitlines() if line.strip()]
        entries: list[tuple[str, dict[str, str]]] = []
        for line in lines:
            match = _GDX.match(line)
            if match is None:
                entries.append((line.strip(), {}))
            elif entries:
                entries[-1][1][match[1]] = match[2]
        if not entries:
            continue
        (image, about), regions = entries[0], entries[1:]
        size = re.findall(_NUMBER, about.get("size", ""))
        frames = [_gdx_frame(name, each) for name, each in regions]
        pages.append(Page(_name(image), _size(*size) if len(size) == 2 else None, frames))
    return pages


def _gdx_frame(name: str, about: dict[str, str]) -> tuple[str, Frame | None]:
    given = about.get("bounds") or f"{about.get('xy', '')},{about.get('size', '')}"
    index = about.get("index", "-1")
    # The packer rotates counterclockwise and gives the size before rotation.
    turned = _quarters(about.get("rotate"), clockwise=False)
    name = name if index == "-1" else f"{name}_{index}"
    return _frame(name, re.findall(_NUMBER, given), turned, upright=True)


_PLACE = ";".join([_NUMBER] * 4)


def _unity(text: str) -> list[Page] | None:
    """Parse a TexturePacker sheet for Unity, in which y is measured from the lower edge."""
    about = dict(re.findall(r"^:(\w+)=(.*?)\s*$", text, re.MULTILINE))
    size = re.findall(_NUMBER, about.get("size", ""))
    if "texture" not in about or len(size) != 2:
        return None
    frames: list[tuple[str, Frame | None]] = []
    for name, *box in re.findall(rf"^([^#:;\n][^;\n]*);{_PLACE}", text, re.MULTILINE):
        left, bottom, width, height = map(float, box)
        frames.append(_frame(name, [left, float(size[1]) - bottom - height, width, height]))
    return [Page(_name(about["texture"]), _size(*size), frames)]


_SLICE = re.compile(
    r"^[ \t]+name: *(.*?)\s*\n\s*rect:\s*(?:serializedVersion: *\d+\s*)?"
    + r"\s+".join(f"{each}:{_NUMBER}" for each in ("x", "y", "width", "height")),
    re.MULTILINE,
)


def _unity_slices(text: str) -> list[Page] | None:
    """Parse the .meta file of a sheet that was sliced in Unity's Sprite Editor."""
    if not re.search(r"^TextureImporter:", text, re.MULTILINE):
        return None
    frames = [_frame(name.strip("'\""), box) for name, *box in _SLICE.findall(text)]
    return [Page("", None, frames, from_below=True)] if frames else None


_BOX = r"[,;\t ]".join([_NUMBER] * 4)
_ROW = re.compile(rf"^\s*\"?(.+?)\"?\s*(?:=\s*|[,;\t]){_BOX}(?:[,;\t ].*)?$")


def _lines(text: str) -> list[Page] | None:
    """Parse text with one sprite per line: ``name = x y width height``, or comma-separated."""
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith(("#", "//"))]
    found = [_ROW.match(line) for line in lines]
    # The first line may be a header.
    frames = [_frame(match[1], list(match.groups()[1:5])) for match in found[not all(found[:1]) :] if match]
    return [Page("", None, frames)] if frames and len(frames) >= len(lines) - 1 else None


FORMATS = (
    Format(
        "JSON (TexturePacker, Aseprite, Phaser, Godot, EaselJS, DragonBones)", (".json", ".tpsheet"), _json
    ),
    Format("XML (Starling, TexturePacker)", (".xml",), _xml),
    Format("property lists (Cocos2d)", (".plist",), _plist),
    Format("libGDX or Spine", (".atlas", ".atlas.txt"), _gdx),
    Format("TexturePacker for Unity", (".tpsheet",), _unity),
    Format("slices of Unity's Sprite Editor", (".png.meta",), _unity_slices),
    Format("lines of name, x, y, width, height", (".txt", ".csv"), _lines),
)
"""All formats, in the order in which they are tried."""
ENDINGS = tuple(dict.fromkeys(["_atlas.json", *(end for each in FORMATS for end in each.endings)]))
"""Endings that follow the sheet's stem in the name of its atlas."""

_LOOKS = (
    (
        "is a TexturePacker project; publish it, and name the file that it writes",
        r"<struct type=\"Settings\"",
    ),
    ("is a Spine skeleton; name its .atlas", r"\A\s*\{[\s\S]*\"(?:skeleton|bones)\"\s*:"),
    ("is a Tiled map or tileset; divide its sheet by --sheet", r"<tileset|<map\s|\"tilewidth\"\s*:"),
    ("is an LDtk project; divide its sheet by --sheet", r"\"__header__\"\s*:"),
    ("is a Unity .meta file without slices; slice the sheet in the Sprite Editor", r"TextureImporter:"),
    ("is a Godot resource", r"\A\s*\[gd_(?:resource|scene)"),
    ("is an SVG picture", r"<svg[\s>]"),
    ("is a web page", r"(?i)<html|<!doctype html"),
    ("looks like a CSS style sheet", r"[\w.#-]+\s*\{[^{}]*:[^{}]*;?[^{}]*\}"),
    ("looks like Lua", r"^\s*(?:local\s+\w+\s*=|return\s*\{)"),
    ("looks like JavaScript", r"^\s*(?:export|module\.exports|const\s|var\s)"),
    ("looks like JSON without a list of sprites", r"\A\s*[\[{]"),
    ("looks like XML without a list of sprites", r"\A\s*<"),
    ("looks like YAML", r"\A(?:%YAML|---|[\w\"'-]+:(?:\s|$))"),
)
"""Descriptions of files that are not atlases, with the pattern of each; the first match is used."""
_BINARY = {b"\x89PNG": "PNG", b"\xff\xd8\xff": "JPEG", b"GIF8": "GIF", b"RIFF": "WebP", b"8BPS": "PSD"}


def _looks_like(content: bytes, text: str) -> str:
    """Return a description of a file that is not an atlas, for a message."""
    picture = next((name for start, name in _BINARY.items() if content.startswith(start)), None)
    if picture is not None:
        return f"is a {picture} picture"
    if content.startswith(b"PK\x03\x04"):
        return "is a ZIP; unpack it"
    if not text.strip():
        return "is empty"
    if "\0" in text:
        return "is not text"
    # The first few thousand characters suffice; matching megabytes would be slow.
    start = text[:4096]
    return next(
        (words for words, pattern in _LOOKS if re.search(pattern, start, re.MULTILINE)),
        "is text of an unknown kind",
    )
