"""Tile grid: the positions of a tileset's tiles, given by the tile size or by a Tiled file."""

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Tree

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.files.limits import read_named
from normalgan.inference.reading.drawings import SMALLEST

ENDINGS = (".tsx", ".tsj", ".json", ".xml")
"""Endings that follow a picture's stem in the name of its tileset file."""
_MOST_TILES = 16384
"""Maximum number of tiles in a picture; the largest sheets in use have a few thousand."""
_MOST_BYTES = 2**24
_SIZE = re.compile(r"(\d{1,4})\s*[x×*]\s*(\d{1,4})((?:\s*,\s*(?:margin|spacing)\s*=\s*\d{1,4})*)")
_EXAMPLE = "give width x height of a tile in pixels, such as 16x16 or 16x16,margin=1,spacing=2"


@dataclass(frozen=True)
class TileGrid:
    """The grid of a picture's tiles; incomplete rows and columns are left out.

    Args:
        width: width of a tile in pixels.
        height: height of a tile in pixels.
        margin: pixels before the first tile, horizontally and vertically.
        spacing: pixels between two tiles.
        size: (width, height) of the picture according to the tileset file; None if the file does not say.
    """

    width: int
    height: int
    margin: int = 0
    spacing: int = 0
    size: tuple[int, int] | None = None

    def counts(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return the numbers of tile columns and rows of a picture (H, W), counted as in Tiled.

        >>> TileGrid(16, 16, margin=1, spacing=2).counts((34, 52))
        (2, 1)
        """
        height, width = (max(side - self.margin + self.spacing, 0) for side in shape)
        return width // (self.width + self.spacing), height // (self.height + self.spacing)

    def check(self, shape: tuple[int, int], name: object) -> str:
        """Return a warning if the last tiles of a picture (H, W) are cut off, otherwise an empty string.

        Raises:
            InputError: if the picture has no tiles or too many, if tiles are too small, or if the size
                differs from the tileset file's.

        >>> TileGrid(16, 16).check((32, 40), "walls.png")
        '8 columns at the right do not form a whole tile'
        """
        height, width = shape
        if self.size is not None and self.size != (width, height):
            raise InputError(
                f"the tileset is for a picture of {self.size[0]} × {self.size[1]} pixels, but {name} has "
                f"{width} × {height}."
            )
        if min(self.width, self.height) < SMALLEST:
            raise InputError(
                f"a tile of {self.width} × {self.height} pixels is too small; "
                f"the minimum is {SMALLEST} a side."
            )
        columns, rows = self.counts(shape)
        if not 0 < columns * rows <= _MOST_TILES:
            raise InputError(
                f"{name} of {width} × {height} pixels has {columns * rows} tiles of {self.width} × "
                f"{self.height}; it needs 1 to {_MOST_TILES}."
            )
        left = [side - each[-1] - 1 for side, each in zip(shape, self.places(shape), strict=True)]
        kept = self.margin + self.spacing
        places = f"{left[1]} columns at the right", f"{left[0]} rows at the bottom"
        named = [words for words, pixels in zip(places, left[::-1], strict=True) if pixels > kept]
        return f"{' and '.join(named)} do not form a whole tile" if named else ""

    def places(self, shape: tuple[int, int]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the indices of the pixel rows and pixel columns of a picture (H, W) that lie in tiles."""
        columns, rows = self.counts(shape)
        return self._lines(rows, self.height), self._lines(columns, self.width)

    def _lines(self, count: int, side: int) -> NDArray[np.intp]:
        first = self.margin + np.arange(count) * (side + self.spacing)
        return (first[:, None] + np.arange(side)).ravel()


def parse_tile_size(text: str) -> TileGrid:
    """Return the grid of a text such as ``16x16`` or ``16x16,margin=1,spacing=2``.

    Raises:
        InputError: if the text is not a tile size.

    >>> parse_tile_size("16x24,spacing=2")
    TileGrid(width=16, height=24, margin=0, spacing=2, size=None)
    """
    match = _SIZE.fullmatch(text.strip().lower())
    if match is None:
        raise InputError(f"tileset is {text!r}; {_EXAMPLE}.")
    more = {name: int(value) for name, value in re.findall(r"(margin|spacing)\s*=\s*(\d+)", match[3])}
    return TileGrid(int(match[1]), int(match[2]), more.get("margin", 0), more.get("spacing", 0))


def read_tiled(path: Path) -> TileGrid:
    """Return the grid of a Tiled tileset in XML (.tsx) or JSON (.tsj).

    Raises:
        InputError: if the file cannot be read, is not a tileset, or is a collection of pictures.
    """
    text = read_named(path, "the tileset", _MOST_BYTES).decode("utf-8-sig", "replace")
    found = _json(text, path) if text.lstrip().startswith("{") else _xml(text, path)
    values = [_whole(found.get(key, 0)) for key in ("tilewidth", "tileheight", "margin", "spacing")]
    width, height, margin, spacing = values
    if not found.get("image"):
        raise InputError(f"the tileset {path} is a collection of pictures; predict these without --tileset.")
    if not width or not height or margin is None or spacing is None:
        raise InputError(f"the tileset {path} has no size of its tiles (tilewidth and tileheight).")
    size = _whole(found.get("imagewidth")), _whole(found.get("imageheight"))
    return TileGrid(width, height, margin, spacing, (size[0], size[1]) if size[0] and size[1] else None)


def _json(text: str, path: Path) -> dict[str, Any]:
    try:
        content = json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        raise InputError(f"the tileset {path} is broken JSON.") from None
    if "tilewidth" not in content or "layers" in content:
        raise _no_tileset(path)
    return dict(content)


def _xml(text: str, path: Path) -> dict[str, Any]:
    if "<tileset" not in text or "<map" in text:
        raise _no_tileset(path)
    if "<!ENTITY" in text:
        raise InputError(f"the tileset {path} declares entities, which are not supported.")
    try:
        root = Tree.fromstring(text.lstrip())
    except (Tree.ParseError, ValueError) as error:
        raise InputError(f"the tileset {path} is broken XML: {error}.") from None
    image = root.find("image")
    if image is None:
        return dict(root.attrib)
    about = {"imagewidth": image.get("width"), "imageheight": image.get("height")}
    return {**root.attrib, "image": image.get("source") or "embedded", **about}


def _no_tileset(path: Path) -> InputError:
    return InputError(
        f"{path} is not a tileset of Tiled (.tsx, .tsj); name one, export the map's tileset from Tiled, or "
        f"{_EXAMPLE}."
    )


def _whole(value: Any) -> int | None:
    """Return a non-negative integer from a JSON or XML value; None for anything else."""
    try:
        return max(int(value), 0)
    except (TypeError, ValueError, OverflowError):
        return None
