"""Sheets: predict the drawings of a sheet separately and assemble the map of the sheet."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.decoding import Decoded, DecodedPixels
from normalgan.errors import InputError
from normalgan.inference.cleaning.reader import Reading, shown_share
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.composition import tiled
from normalgan.inference.composites.series import Member, flat_map, left_flat, predict_series
from normalgan.inference.findings import Finding, join
from normalgan.inference.mask.decision import NoRegionError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.parallel import result_of, stream
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import SMALLEST
from normalgan.inference.reading.picture import to_picture

MOST_CELLS = 4096
"""Maximum number of drawings in a sheet; the largest atlases in use have a few hundred."""
_NAMED = 3
"""Maximum number of cells that a warning names; the others are only counted."""


def parse_grid(text: str) -> tuple[int, int]:
    """Return the columns and rows of a grid such as ``4x3``.

    Raises:
        InputError: if the text is not a grid.

    >>> parse_grid("4x3")
    (4, 3)
    """
    match = re.fullmatch(r"(\d{1,4})\s*[x×*]\s*(\d{1,4})", text.strip().lower())
    columns, rows = map(int, match.groups()) if match else (0, 0)
    if not 0 < columns * rows <= MOST_CELLS:
        raise InputError(
            f"sheet is {text!r}; give columns x rows, such as 4x3, of at most {MOST_CELLS} cells."
        )
    return columns, rows


def grid_cells(columns: int, rows: int, shape: tuple[int, int], name: object) -> list[Cell]:
    """Return the cells of a sheet (H, W) that is divided into an even grid, row by row.

    Raises:
        InputError: if the sheet cannot be divided evenly, or its cells would be too small.
    """
    height, width = shape
    if width % columns or height % rows:
        raise InputError(
            f"{name} is {width} × {height} pixels, which {columns} columns and {rows} rows do not divide "
            "evenly."
        )
    w, h = width // columns, height // rows
    if min(w, h) < SMALLEST:
        raise InputError(
            f"the cells of {name} would be {w} × {h} pixels; a drawing needs at least {SMALLEST} a side."
        )
    return [
        Cell(f"row {row + 1}, column {column + 1}", column * w, row * h, w, h)
        for row in range(rows)
        for column in range(columns)
    ]


def predict_sheet(
    predictor: Predictor,
    sheet: Decoded,
    cells: Sequence[Cell],
    page: Member,
    shared: bool = False,
    said: Sequence[str] = (),
    scale: float = 1.0,
) -> NormalMap:
    """Return the map of a sheet, predicting each cell as if it were a file of its own.

    Args:
        predictor: the network.
        sheet: pixels of the sheet, not reduced.
        cells: cells of the drawings. Empty and tiny cells stay flat.
        page: the sheet as one drawing, whose hints, mask (H, W), holes and reading are divided among the
            cells. A cell that the reader would see better by itself is read again.
        shared: whether all cells are framed by one square; they must then have the same size.
        said: other warnings about the sheet, each part of a sentence.
        scale: pixels of the sheet per pixel of the drawing, in which warnings give places.

    Raises:
        InputError: if no cell can be predicted, cells that share a frame differ in size, or a hole lies in no
            cell.
    """
    for x, y in page.holes:
        if not any(cell.points([(x, y)]) for cell in cells):
            raise InputError(
                f"no drawing of the sheet lies at x {x / scale:g}, y {y / scale:g}; give a point inside "
                "closed lines."
            )
    drawn = drawings_in(sheet, cells, page)
    if not drawn:
        raise InputError("none of its cells holds a drawing; give other columns and rows, or another atlas.")
    large = [(cell, member) for cell, member in drawn if min(cell.width, cell.height) >= SMALLEST]
    single = [(cell, member) for cell, member in large if cell.tile is None]
    predicted = predict_series(predictor, [member for _, member in single], shared, shared)
    done = [(cell, each) for (cell, _), each in zip(single, predicted, strict=True)]
    done += _repeated(predictor, [(cell, member) for cell, member in large if cell.tile is not None])
    for cell, _ in drawn:
        if min(cell.width, cell.height) < SMALLEST:
            size = f"{cell.width} × {cell.height} pixels; a drawing needs at least {SMALLEST} a side."
            done.append((cell, InputError(f"it is {size}")))
    for cell, each in done:
        if isinstance(each, NoRegionError):
            ((x, y),) = cell.in_sheet([(each.x, each.y)])
            raise NoRegionError.at(x / scale, y / scale)
    fine = [(cell, each) for cell, each in done if isinstance(each, NormalMap)]
    if not fine:
        cell, error = done[0]
        others = f"none of its {len(done)} drawings can be predicted; " if len(done) > 1 else ""
        raise InputError(f"{others}{cell.name}: {error}")
    return replace(_assembled(sheet.shape, fine, _findings(done, said, scale)), partial=len(fine) < len(done))


def drawings_in(sheet: Decoded, cells: Sequence[Cell], page: Member) -> list[tuple[Cell, Member]]:
    """Return the non-empty cells of a sheet with their drawings; arguments as in `predict_sheet`."""
    pixels = sheet.pixels
    clear = pixels.ndim == 3 and pixels.shape[2] == 4 and bool(np.ptp(pixels[..., 3]))
    members = [(cell, _member(cell, pixels, page, clear)) for cell in cells]
    return [(cell, member) for cell, member in members if member is not None]


def _shared(reading: Reading | None, cell: Cell, shape: tuple[int, int]) -> Reading | None:
    """Return the part of a sheet's reading in a cell; None if the reader sees more of the cell by itself."""
    if reading is None:
        return None
    # The sides of a reading are rounded, by less than a tenth.
    if shown_share(max(cell.width, cell.height)) > 1.1 * reading.ink.shape[1] / shape[1] or cell.turned:
        return None
    part = reading.part(cell.box, shape)
    if cell.own is None:
        return part
    own = cv2.resize(cell.own.astype(np.uint8), part.ink.shape[::-1], interpolation=cv2.INTER_NEAREST)
    return replace(part, ink=part.ink * own, presence=part.presence * own)


def _repeated(
    predictor: Predictor, drawn: Sequence[tuple[Cell, Member]]
) -> Iterator[tuple[Cell, NormalMap | InputError]]:
    """Yield each cell whose drawing repeats, with its map or the error."""

    def predict(each: tuple[Cell, Member]) -> NormalMap:
        cell, member = each
        return predictor(member.picture, member.hints, member.mask, tile=cell.tile)

    for (cell, _), got in stream(drawn, predict):
        yield cell, got if isinstance(got, InputError) else result_of(got)


def _member(cell: Cell, pixels: DecodedPixels, page: Member, clear: bool) -> Member | None:
    """Return the drawing in a cell of a sheet that has ``clear`` parts or none; None if the cell is empty."""
    part = pixels[cell.box].copy()
    if cell.own is not None and not cell.own.all():
        part[~cell.own] = 0 if clear else _ground(part, cell.own)
    part = np.ascontiguousarray(cell.upright(part))
    if not part[..., 3].any() if clear else (part == part[:1, :1]).all():
        return None
    own = cell.upright(page.mask[cell.box]) if isinstance(page.mask, np.ndarray) else page.mask
    if isinstance(own, np.ndarray) and not own.any():
        return None
    picture = to_picture(Decoded(part, (part.shape[0], part.shape[1])))
    if clear:
        opacity = np.ones(picture.size, np.float32) if picture.alpha is None else picture.alpha
        picture = replace(picture, alpha=opacity, cut_out=True)
    hints = None if page.hints is None else cell.local(page.hints)
    reading = _shared(page.reading, cell, (pixels.shape[0], pixels.shape[1]))
    return Member(picture, hints, own, cell.points(page.holes), reading, pixel_art=page.pixel_art)


def _ground(part: DecodedPixels, own: BoolMask) -> NDArray[np.generic]:
    """Return the colour of the paper around a drawing: the median along the edge of its own pixels."""
    edge = own & (cv2.erode(own.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) == 0)
    return np.asarray(np.median(part[edge], axis=0)).astype(part.dtype)


def _assembled(
    shape: tuple[int, int], predicted: Sequence[tuple[Cell, NormalMap]], findings: tuple[Finding, ...]
) -> NormalMap:
    """Return the map of a sheet (H, W), assembled from the maps of its cells."""
    whole = flat_map(shape)
    sure = any(each.confidence is not None for _, each in predicted)
    confidence = np.zeros(shape, np.float32) if sure else None
    for cell, preds in predicted:
        # The boxes of irregular drawings overlap, so each drawing only writes its own pixels.
        there = cell.turn(preds.mask | (preds.alpha > 0)) if cell.own is not None else np.s_[:]
        whole.extended[cell.box][there] = cell.turn(preds.extended)[there]
        whole.mask[cell.box][there] = cell.turn(preds.mask)[there]
        whole.alpha[cell.box][there] = cell.turn(preds.alpha)[there]
        if confidence is not None and preds.confidence is not None:
            confidence[cell.box][there] = cell.turn(preds.confidence)[there]
    seen, cells = tiled([each.seen for _, each in predicted]), tuple(cell for cell, _ in predicted)
    return replace(whole, seen=seen, confidence=confidence, findings=findings, cells=cells)


def _words(cell: Cell, preds: NormalMap, scale: float) -> str:
    """Return the texts of the findings about a cell, with places in pixels of the whole drawing."""
    whole = ((each, cell.in_sheet(each.places)) for each in preds.findings)
    return join(
        replace(each, places=tuple((x / scale, y / scale) for x, y in places)) for each, places in whole
    )


def _findings(
    done: Sequence[tuple[Cell, NormalMap | InputError]], others: Sequence[str], scale: float
) -> tuple[Finding, ...]:
    """Return the findings about the cells."""
    said = [
        (cell, left_flat(each) if isinstance(each, InputError) else _words(cell, each, scale))
        for cell, each in done
    ]
    named = [*others, *(f"{cell.name}: {words}" for cell, words in said if words)]
    more = f"; and so on, {len(named)} in all" if len(named) > _NAMED else ""
    return (Finding("note", words="; ".join(named[:_NAMED]) + more),) if named else ()
