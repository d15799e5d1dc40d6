"""SVG: removal of links to other files, and rendering."""

import base64
import binascii
import io
import re
from collections.abc import Iterator
from pyexpat import ErrorString, ExpatError, ParserCreate

from .opening import KNOWN, RefusedError, first_line, opened

MOST_DEPTH = 128
"""Maximum nesting of elements in an SVG, because the drawing library recurses and crashes without stack."""
_MOST_TEXT = 2**26
"""Maximum number of characters of an SVG after entities are expanded."""
_DPI = 96.0
"""Pixels per inch in CSS, needed to convert millimetres."""
_EMBEDDED = re.compile(r"data:image/(?:png|jpe?g|gif|webp);base64,", re.IGNORECASE)


def is_svg(content: bytes) -> bool:
    r"""Return whether a file is an SVG, not only a picture with an SVG in its metadata.

    >>> is_svg(b'<?xml version="1.0"?><!-- long --><svg/>'), is_svg(b"\x89PNG... <svg")
    (True, False)
    """
    start = content[:64].removeprefix(b"\xef\xbb\xbf").lstrip()
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return "<" in content[2:64].decode("utf-16-le" if content[:1] == b"\xff" else "utf-16-be", "replace")
    return start.startswith(b"<")


def draw_svg(content: bytes, side: int, most: int) -> bytes:
    """Render an SVG and return it as PNG, transparent where it is empty.

    Args:
        content: content of the file.
        side: longer side of the rendering in pixels.
        most: maximum side of embedded pictures in pixels.

    Raises:
        RefusedError: if the SVG cannot be rendered, or would draw another file.
    """
    from PIL import Image
    from resvg_py import svg_to_bytes

    text = sanitize_svg(content, most)
    try:
        # Without fonts, because the result must not depend on the fonts of the machine. Fitted to a
        # square, because a very tall SVG with only a width would exhaust memory.
        small = bytes(svg_to_bytes(svg_string=text, width=64, height=64, dpi=_DPI, skip_system_fonts=True))
        with Image.open(io.BytesIO(small), formats=("PNG",)) as image:
            wide = image.height <= image.width
        width, height = (side, None) if wide else (None, side)
        return bytes(
            svg_to_bytes(svg_string=text, width=width, height=height, dpi=_DPI, skip_system_fonts=True)
        )
    except ValueError as error:
        raise RefusedError(f"cannot be drawn as SVG: {first_line(error)}") from None
    except BaseException as error:  # a Rust panic is a BaseException
        if isinstance(error, MemoryError):
            raise
        raise RefusedError(f"cannot be drawn as SVG: {first_line(error)}") from None


def sanitize_svg(content: bytes, most: int) -> str:
    """Return a copy of an SVG with expanded entities and without external links.

    The SVG is rewritten, not only checked, because another parser may read the same bytes differently.

    Args:
        content: content of the file, in any XML encoding.
        most: maximum side of embedded pictures in pixels.

    Raises:
        RefusedError: if the file is not XML, is nested too deeply, is too long, or would draw another file.
    """
    parser = ParserCreate()
    parser.buffer_text = True
    written: list[str] = []
    depth = length = 0

    def write(text: str) -> None:
        nonlocal length
        length += len(text)
        if length > _MOST_TEXT:
            raise RefusedError(f"stands for more than {_MOST_TEXT} characters of SVG")
        written.append(text)

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MOST_DEPTH:
            raise RefusedError(f"is nested more than {MOST_DEPTH} deep; drawings are not")
        if depth == 1 and _local(name) != "svg":
            raise RefusedError(f"is not an image that can be read; use {KNOWN}")
        kept = "".join(
            f' {key}="{_escaped(value)}"' for key, value in _allowed(_local(name), attributes, most)
        )
        write(f"<{name}{kept}>")

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1
        write(f"</{name}>")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = lambda data: write(_escaped(data))
    try:
        parser.Parse(content, True)
    except ExpatError as error:
        words = f"cannot be drawn as SVG: line {error.lineno}: {ErrorString(error.code)}"
        raise RefusedError(words) from None
    except (ValueError, LookupError) as error:  # an invalid encoding
        raise RefusedError(f"cannot be drawn as SVG: {first_line(error)}") from None
    return "".join(written)


def _allowed(name: str, attributes: dict[str, str], most: int) -> Iterator[tuple[str, str]]:
    """Yield an element's attributes without external links.

    Raises:
        RefusedError: if the element would draw an external file.
    """
    for key, value in attributes.items():
        if _local(key) == "href":
            link = value.strip()
            if name in {"image", "feImage"} and not link.startswith("#"):
                _check_embedded(link, most)
            elif not link.startswith("#"):
                continue  # a hyperlink, or a part of another file
        yield key, value


def _check_embedded(link: str, most: int) -> None:
    """Raise `RefusedError` if a picture in an SVG is not embedded, or is too large."""
    start = _EMBEDDED.match(link)
    if start is None:
        shown = link if len(link) <= 60 else f"{link[:57]}…"
        raise RefusedError(
            f"draws {shown!r}, but external files are not read; embed the picture as PNG, JPEG, GIF or WebP"
        )
    try:
        # Ignores characters that are not base64, like the drawing library.
        data = base64.b64decode(re.sub(r"\s+", "", link[start.end() :]) + "===", validate=False)
        with opened(data) as image:
            size = image.size
    except (OSError, SyntaxError, ValueError, binascii.Error) as error:
        raise RefusedError(f"has a picture in it that cannot be read: {first_line(error)}") from None
    if max(size) > most:
        raise RefusedError(
            f"has a picture of {size[0]} × {size[1]} pixels in it; at most {most} per side can be read"
        )


def _local(name: str) -> str:
    """Return an XML name without its prefix."""
    return name.rpartition(":")[2]


def _escaped(text: str) -> str:
    if "&" in text or "<" in text or ">" in text or '"' in text:
        text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
    return text.replace("\n", "&#10;").replace("\t", "&#9;").replace("\r", "&#13;")
