"""SVG size: read the size of an SVG in its own units."""

import re
from contextlib import suppress
from pyexpat import ExpatError, ParserCreate

_PIXELS = {
    "": 1.0,
    "px": 1.0,
    "pt": 4 / 3,
    "pc": 16.0,
    "in": 96.0,
    "cm": 96 / 2.54,
    "mm": 9.6 / 2.54,
    "q": 2.4 / 2.54,
}
"""CSS pixels per unit; https://www.w3.org/TR/css-values-4/#absolute-lengths."""
_LENGTH = re.compile(r"\s*(\d*\.?\d+(?:e[+-]?\d+)?)\s*([a-z]*)\s*", re.IGNORECASE)


class _FoundError(Exception):
    """Raised to stop the parser at the first element."""


def svg_size(content: bytes) -> tuple[float, float] | None:
    """Return (width, height) of an SVG in CSS pixels, or else of its view box; None if it has neither.

    Only the first element is parsed.

    >>> svg_size(b'<svg width="2in" height="96"/>'), svg_size(b'<svg viewBox="0 0 30 20"/>')
    ((192.0, 96.0), (30.0, 20.0))
    """
    about: dict[str, str] = {}
    parser = ParserCreate()

    def start(_: str, attributes: dict[str, str]) -> None:
        about.update(attributes)
        raise _FoundError

    def entity(*_: object) -> None:
        raise _FoundError

    parser.StartElementHandler = start
    parser.EntityDeclHandler = entity  # entities can expand to more than fits in memory
    with suppress(_FoundError, ExpatError, ValueError, LookupError):
        parser.Parse(content, True)
    width, height = _length(about.get("width", "")), _length(about.get("height", ""))
    if width and height:
        return width, height
    box = [_length(each) for each in re.split(r"[\s,]+", about.get("viewBox", "").strip())]
    if len(box) == 4 and box[2] and box[3]:
        return box[2], box[3]
    return None


def _length(text: str) -> float | None:
    match = _LENGTH.fullmatch(text)
    scale = _PIXELS.get(match[2].lower()) if match else None
    return float(match[1]) * scale if match and scale else None
