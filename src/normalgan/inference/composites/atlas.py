"""Atlas: the JSON in which TexturePacker and Aseprite say where the sprites of a sheet lie."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.files.limits import read_bounded
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.sheets import MOST_CELLS

__all__ = ["ENDINGS", "MOST_BYTES", "read_atlas"]

MOST_BYTES = 2**24
"""Larger atlases are refused; each sprite takes some three hundred bytes."""
ENDINGS = (".json", "_atlas.json")
"""What the atlas of a sheet is named, after its stem."""


def read_atlas(path: Path, shape: tuple[int, int], sheet: Path) -> list[Cell]:
    """Return where the sprites of a sheet lie; those that share a place once.

    Args:
        path: of the atlas: JSON as a hash or an array of frames, or Phaser's with several textures.
        shape: (H, W) of the sheet.
        sheet: its file.

    Raises:
        InputError: if it cannot be read, or disagrees with the sheet.
    """
    try:
        content = json.loads(read_bounded(path, MOST_BYTES))
    except OSError as error:
        raise InputError(f"the atlas {path} cannot be read: {error.strerror}.") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"the atlas {path} is no JSON: {brief(error)}.") from None
    content, size = _texture(content, sheet, path)
    frames = list(_frames(content))
    if not 0 < len(frames) <= MOST_CELLS:
        raise InputError(
            f"the atlas {path} lists {len(frames)} sprites; the JSON of TexturePacker or Aseprite lists 1 to "
            f"{MOST_CELLS} under frames."
        )
    height, width = shape
    if size is not None and size != (width, height):
        raise InputError(
            f"the atlas {path} is of a sheet of {size[0]} × {size[1]} pixels, but {sheet} has "
            f"{width} × {height}."
        )
    cells: dict[tuple[int, ...], Cell] = {}
    for name, frame in frames:
        cell = _cell(name, frame, path)
        if cell.left < 0 or cell.top < 0 or cell.left + cell.width > width or cell.top + cell.height > height:
            raise InputError(
                f"the atlas {path} has the sprite {name!r} at x {cell.left}, y {cell.top} with "
                f"{cell.width} × {cell.height} pixels, which do not lie in {sheet}, {width} × {height}."
            )
        cells.setdefault((cell.left, cell.top, cell.width, cell.height), cell)
    return list(cells.values())


def _texture(content: Any, sheet: Path, path: Path) -> tuple[Any, tuple[int, int] | None]:
    """Return what lists the sprites of a sheet, and (width, height) of the sheet as it says."""
    if isinstance(content, dict) and isinstance(content.get("textures"), list):
        textures = {
            Path(str(each.get("image", ""))).name: each
            for each in content["textures"]
            if isinstance(each, dict)
        }
        if len(textures) > 1 and sheet.name not in textures:
            raise InputError(
                f"the atlas {path} has the sprites of {', '.join(textures)}; none of these is {sheet.name}."
            )
        content = textures.get(sheet.name) or next(iter(textures.values()), {})
        return content, _size(content.get("size"))
    meta = content.get("meta") if isinstance(content, dict) else None
    return content, _size(meta.get("size") if isinstance(meta, dict) else None)


def _size(content: Any) -> tuple[int, int] | None:
    match content:
        case {"w": int(width), "h": int(height)}:
            return width, height
        case _:
            return None


def _frames(content: Any) -> Iterator[tuple[str, Any]]:
    frames = content.get("frames") if isinstance(content, dict) else None
    if isinstance(frames, dict):
        yield from frames.items()
    elif isinstance(frames, list):
        for number, each in enumerate(frames, 1):
            yield str(each.get("filename", number)) if isinstance(each, dict) else str(number), each


def _cell(name: str, frame: Any, path: Path) -> Cell:
    match frame:
        case {"frame": {"x": int(x), "y": int(y), "w": int(w), "h": int(h)}} if w > 0 and h > 0:
            turned = frame.get("rotated") is True
            # Both programs give the size that the sprite has upright.
            return Cell(name, x, y, *((h, w) if turned else (w, h)), turned)
        case _:
            raise InputError(
                f"the atlas {path} has the sprite {name!r} without a place; "
                "it needs a frame with whole x, y, w and h."
            )
