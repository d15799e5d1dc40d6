"""Pictures made to harm: each of a few kilobytes, each true to its format's grammar."""

import base64
import io
import struct
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

SPACES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
SVG = f'<svg {SPACES} viewBox="0 0 64 64">'
LINE = '<path d="M4 4L60 60" stroke="#000" stroke-width="3"/>'


SLOW = "it takes more than 1 seconds of processor time"


def svg(body: str, before: str = "") -> bytes:
    """Return an SVG with something in it beside a line."""
    return f"{before}{SVG}{LINE}{body}</svg>".encode()


def nested(element: str, count: int) -> str:
    """Return elements in one another."""
    return f"<{element}>" * count + LINE + f"</{element.partition(' ')[0]}>" * count


def chain(kind: str, count: int, inside: str, reference: str) -> str:
    """Return elements each of which asks for the one before ten times."""
    parts = [f'<{kind} id="a0">{inside}</{kind}>']
    for i in range(1, count):
        asks = reference.format(i - 1) * 10
        parts.append(f'<{kind} id="a{i}">{asks}</{kind}>')
    return "".join(parts) + reference.format(count - 1)


def doubled(kind: str, attributes: str, asks: str) -> str:
    """Return forty elements each of which asks twice for the one before."""
    return "".join(f'<{kind} id="a{i}" {attributes}>{asks.format(i - 1) * 2}</{kind}>' for i in range(1, 40))


def entities(count: int) -> str:
    """Return a declaration of entities that stand for ten to the power of ``count`` characters."""
    levels = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, count))
    return f'<!DOCTYPE svg [<!ENTITY a0 "x">{levels}]>'


def embedded(content: bytes, kind: str = "png") -> str:
    """Return an element of SVG that draws a picture in it."""
    link = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    return f'<image width="64" height="64" href="{link}"/>'


def chunk(kind: bytes, data: bytes) -> bytes:
    """Return a chunk of a PNG."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, *extra: bytes, data: bytes = b"") -> bytes:
    """Return a PNG of 8-bit greys that claims a size, with chunks before its pixels."""
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    pixels = chunk(b"IDAT", data or zlib.compress(bytes(1000)))
    return b"\x89PNG\r\n\x1a\n" + head + b"".join(extra) + pixels + chunk(b"IEND", b"")


def tiff(*entries: tuple[int, int, int, int], data: bytes = b"") -> bytes:
    """Return a TIFF of one directory of (tag, type, count, value), after whose head the data lie."""
    start = 8 + len(data)
    directory = struct.pack("<H", len(entries)) + b"".join(
        struct.pack("<HHII", *each) for each in sorted(entries)
    )
    return b"II*\0" + struct.pack("<I", start) + data + directory + struct.pack("<I", 0)


def white_tiff(side: int, channels: int = 1) -> bytes:
    """Return a TIFF of an honest size whose pixels take next to nothing in the file."""
    file = io.BytesIO()
    Image.new("L" if channels == 1 else "RGBA", (side, side), "white").save(
        file, "TIFF", compression="tiff_adobe_deflate"
    )
    return file.getvalue()


def gif(width: int, height: int, data: bytes) -> bytes:
    """Return a GIF that claims a size for its screen and its picture."""
    screen = struct.pack("<HHBBB", width, height, 0x80, 0, 0) + b"\0\0\0\xff\xff\xff"
    picture = b"," + struct.pack("<HHHHB", 0, 0, width, height, 0) + b"\x02" + bytes([len(data)]) + data
    return b"GIF89a" + screen + picture + b"\0;"


def eps() -> bytes:
    """Return a program in PostScript under the name of a picture: Ghostscript would run it."""
    return b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 64 64\n%%EndComments\n(touched) (w) file closefile\n"


def hostile(secret: Path) -> dict[str, tuple[bytes, str]]:
    """Return pictures by name, each with a part of the sentence that refuses it.

    Args:
        secret: a picture that is no business of whoever draws these.
    """
    blur = "".join(f'<feGaussianBlur stdDeviation="{i}"/>' for i in range(1, 400))
    pattern = 'width="1" height="1" patternUnits="userSpaceOnUse"'
    huge = zlib.compress(bytes(2**20))
    return {
        "groups.svg": (svg(nested("g", 900)), "is nested more than 128 deep"),
        "opaque_groups.svg": (svg(nested('g opacity="0.5"', 900)), "is nested more than 128 deep"),
        "svgs.svg": (svg(nested("svg", 5000)), "is nested more than 128 deep"),
        "turbulence.svg": (
            svg(
                '<filter id="f" x="0" y="0" width="1" height="1"><feTurbulence baseFrequency="0.9" '
                'numOctaves="30000000"/></filter><rect width="64" height="64" filter="url(#f)"/>'
            ),
            SLOW,
        ),
        "blurs.svg": (
            svg(f'<filter id="f">{blur * 40}</filter><g filter="url(#f)"><rect width="64" height="64"/></g>'),
            SLOW,
        ),
        "laughing_uses.svg": (svg(chain("g", 12, LINE, '<use xlink:href="#a{}"/>')), "nodes limit reached"),
        "patterns.svg": (
            svg(
                doubled("pattern", pattern, '<rect width="64" height="64" fill="url(#a{})"/>')
                + '<rect width="64" height="64" fill="url(#a39)"/>'
            ),
            SLOW,
        ),
        "masks.svg": (
            svg(
                doubled("mask", "", f'<g mask="url(#a{{}})">{LINE}</g>')
                + '<rect width="64" height="64" mask="url(#a39)"/>'
            ),
            SLOW,
        ),
        "clips.svg": (
            svg(
                doubled("clipPath", "", '<rect width="64" height="64" clip-path="url(#a{})"/>')
                + '<rect width="64" height="64" clip-path="url(#a39)"/>'
            ),
            SLOW,
        ),
        "laughs.svg": (svg("<text>&a9;</text>", entities(10)), "cannot be drawn as SVG"),
        "zero.svg": (svg('<image width="64" height="64" href="/dev/zero"/>'), "draws '/dev/zero'"),
        "file.svg": (svg(f'<image width="64" height="64" href="{secret}"/>'), "external files are not read"),
        "prefix.svg": (
            svg(f'<image width="64" height="64" xlink:href="file://{secret}"/>'),
            "external files are not read",
        ),
        "fe.svg": (
            svg(f'<filter id="f"><feImage href="{secret}"/></filter><rect width="9" filter="url(#f)"/>'),
            "external files are not read",
        ),
        "entity.svg": (
            svg('<image width="64" height="64" href="&e;"/>', f'<!DOCTYPE svg [<!ENTITY e "{secret}">]>'),
            "external files are not read",
        ),
        "inner.svg": (
            svg(embedded(svg(f'<image width="64" height="64" href="{secret}"/>'), "svg+xml")),
            "external files are not read",
        ),
        "plain.svg": (
            svg(
                '<image width="64" height="64" href="data:text/plain;base64,'
                + base64.b64encode(svg('<image href="/dev/zero"/>')).decode()
                + '"/>'
            ),
            "external files are not read",
        ),
        "bomb.svg": (svg(embedded(png(60_000, 60_000, data=huge))), "has a picture of 60000 × 60000 pixels"),
        "no_end.svg": (SVG.encode() * 2000, "cannot be drawn as SVG|is nested more than"),
        "eps.png": (eps(), "is not an image that can be read"),
        "size.png": (png(2**31 - 1, 2**31 - 1), "is 2147483647 × 2147483647 pixels"),
        "high.png": (png(8, 2**30), "is 8 × 1073741824 pixels"),
        "text.png": (
            png(64, 64, *[chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(2**20)))] * 200),
            "cannot be read as an image",
        ),
        "profile.png": (
            png(64, 64, chunk(b"iCCP", b"a\0\0" + zlib.compress(bytes(2**27)))),
            "cannot be read as an image",
        ),
        "tile.tiff": (
            tiff(
                *((256, 4, 1, 64), (257, 4, 1, 64), (258, 3, 1, 8), (259, 3, 1, 8), (262, 3, 1, 1)),
                *((277, 3, 1, 1), (322, 4, 1, 2**30), (323, 4, 1, 2**30), (324, 4, 1, 8), (325, 4, 1, 64)),
                data=zlib.compress(bytes(64)),
            ),
            "cannot be read as an image",
        ),
        "strips.tiff": (
            tiff(
                *((256, 4, 1, 64), (257, 4, 1, 64), (258, 3, 1, 8), (259, 3, 1, 8), (262, 3, 1, 1)),
                *((273, 4, 2**30, 8), (277, 3, 1, 1), (278, 4, 1, 1), (279, 4, 2**30, 64)),
            ),
            "is not an image that can be read|cannot be read as an image",
        ),
        "samples.tiff": (
            tiff(
                *((256, 4, 1, 8192), (257, 4, 1, 8192), (258, 3, 1, 32), (259, 3, 1, 8), (262, 3, 1, 1)),
                *((273, 4, 1, 8), (277, 3, 1, 60_000), (278, 4, 1, 8192), (279, 4, 1, 64)),
                data=bytes(64),
            ),
            "is not an image that can be read|cannot be read as an image",
        ),
        "screen.gif": (gif(65535, 65535, b"\x44\x01"), "is 65535 × 65535 pixels"),
        "codes.gif": (gif(8000, 8000, b"\xff" * 200), "cannot be read as an image"),
    }


def secret_picture(path: Path) -> Path:
    """Write a picture that nobody else should see: a black square."""
    Image.fromarray(np.zeros((64, 64), np.uint8)).save(path)
    return path
