"""Atlas: read the positions of a sheet's sprites from another program's file."""

from dataclasses import dataclass, replace
from pathlib import Path

from normalgan.errors import InputError
from normalgan.files.limits import read_named
from normalgan.inference.composites.atlas_formats import (
    ENDINGS,
    Frame,
    Page,
    UnreadableAtlasError,
    parse_atlas,
)
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.sheets import MOST_CELLS

__all__ = ["ENDINGS", "MOST_BYTES", "AtlasCells", "read_atlas"]

MOST_BYTES = 2**24
"""Maximum size of an atlas in bytes; each sprite takes about 300."""
_ALIKE = 0.01
"""Maximum relative difference between the aspect ratios of an SVG and of the sheet in its atlas."""


@dataclass(frozen=True)
class AtlasCells:
    """The sprites that an atlas lists for a sheet.

    Args:
        cells: positions of the usable sprites, without duplicates.
        warnings: reasons why other sprites are left out; each is part of a sentence and names its sprite.
    """

    cells: list[Cell]
    warnings: list[str]


def read_atlas(
    path: Path, shape: tuple[int, int], sheet: Path, units: tuple[float, float] | None = None
) -> AtlasCells:
    """Return the positions of a sheet's sprites.

    Empty sprites are left out. Sprites outside the sheet are left out with a warning.

    Args:
        path: the atlas, in any format of `atlas_formats.FORMATS`.
        shape: (H, W) of the sheet in pixels.
        sheet: file of the sheet.
        units: (width, height) of a vector sheet (SVG) in its own units; None for a sheet of pixels.

    Raises:
        InputError: if the atlas cannot be read, does not match the sheet, or has no usable sprite.
    """
    try:
        pages = parse_atlas(read_named(path, "the atlas", MOST_BYTES))
    except UnreadableAtlasError as error:
        raise InputError(f"the atlas {path} {error}.") from None
    page = _page_of(pages, sheet, path)
    if not 0 < len(page.frames) <= MOST_CELLS:
        raise InputError(
            f"the atlas {path} lists {len(page.frames)} sprites for {sheet.name}; it needs 1 to {MOST_CELLS}."
        )
    scale = _scale(page, shape, sheet, path, units)
    cells: dict[tuple[int, ...], Cell] = {}
    warnings: list[str] = []
    for name, given in page.frames:
        if given is None:
            warnings.append(f"the sprite {name!r} has no position; it needs x, y, width and height")
            continue
        frame = given
        if page.from_below:
            lower_edge = shape[0] if units is None else units[1]
            frame = replace(given, top=lower_edge - given.top - given.height)
        cell = _cell(frame, scale)
        if not cell.width or not cell.height:
            continue
        if (
            cell.left < 0
            or cell.top < 0
            or cell.left + cell.width > shape[1]
            or cell.top + cell.height > shape[0]
        ):
            warnings.append(
                f"the sprite {name!r} at x {frame.left:g}, y {frame.top:g} with {frame.width:g} × "
                f"{frame.height:g} pixels lies outside of {sheet.name}"
            )
            continue
        cells.setdefault((cell.left, cell.top, cell.width, cell.height), cell)
    if not cells:
        raise InputError(
            f"the atlas {path}: {warnings[0] if warnings else 'none of its sprites has pixels'}."
        )
    return AtlasCells(list(cells.values()), warnings)


def _page_of(pages: list[Page], sheet: Path, path: Path) -> Page:
    """Return the sprites that an atlas lists for a sheet; an atlas of several sheets must name it."""
    named = next((each for each in pages if each.image == sheet.name), None)
    if named is not None:
        return named
    if len(pages) > 1:
        names = ", ".join(each.image for each in pages if each.image)
        raise InputError(f"the atlas {path} has the sprites of {names}; none of these is {sheet.name}.")
    return pages[0] if pages else Page("", None, [])


def _scale(
    page: Page, shape: tuple[int, int], sheet: Path, path: Path, units: tuple[float, float] | None
) -> tuple[float, float]:
    """Return the number of pixels per unit of an atlas, horizontally and vertically.

    Raises:
        InputError: if the atlas belongs to a sheet of a different size.
    """
    height, width = shape
    size = page.size or units
    if size is None or size == (width, height):
        return 1.0, 1.0
    scale = width / size[0], height / size[1]
    if units is None or abs(scale[0] / scale[1] - 1) > _ALIKE + 1 / min(shape):
        raise InputError(
            f"the atlas {path} is for a sheet of {size[0]:g} × {size[1]:g} pixels, but {sheet} has "
            f"{width} × {height}."
        )
    return scale


def _cell(frame: Frame, scale: tuple[float, float]) -> Cell:
    left, right = (round(each * scale[0]) for each in (frame.left, frame.left + frame.width))
    top, bottom = (round(each * scale[1]) for each in (frame.top, frame.top + frame.height))
    return Cell(frame.name, left, top, right - left, bottom - top, frame.turned)
