"""Islands: find the drawings of a sheet without an atlas, by connected components."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask
from normalgan.decoding import Decoded
from normalgan.errors import InputError
from normalgan.inference.cleaning.ink import clean
from normalgan.inference.cleaning.reader import read
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.sheets import MOST_CELLS
from normalgan.inference.reading.drawings import SMALLEST
from normalgan.inference.reading.picture import MOST_WORKED, fitted_within, resize, to_picture
from normalgan.inference.regions import INKED, enclosed_by

_GAP = 0.004
"""Half the widest gap across which parts count as connected, as a fraction of the sheet's longer side."""
_FAINT = 8
"""Highest opacity, out of 255, that counts as transparent."""
_SMALL = 0.2
"""Span below which a drawing may be a part of a neighbour, as a fraction of the largest drawing's span."""
_BESIDE = 0.1
"""Greatest distance between a small part and its drawing, as a fraction of the drawing's span."""

_Boxes = NDArray[np.intp]


def find_islands(sheet: Decoded) -> list[Cell]:
    """Return the cells of a sheet's drawings, row by row: islands, or connected lines if the sheet is opaque.

    Lines with a narrow gap between them count as connected. A small part, such as an eye or a spark, joins
    the large part next to it.

    Args:
        sheet: pixels of the sheet, not reduced.

    Raises:
        InputError: if there are no drawings, or too many.
    """
    shape = sheet.pixels.shape[0], sheet.pixels.shape[1]
    opaque = _opaque(sheet)
    near = (_lines(sheet) if opaque is None else opaque).astype(np.uint8)
    if opaque is None:  # a pen leaves gaps
        reach = max(round(_GAP * max(shape)), 1)
        near = np.asarray(cv2.dilate(near, np.ones((2 * reach + 1,) * 2, np.uint8)))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(near, connectivity=8)
    if count < 2:
        raise InputError("no drawing was found in it; a sheet needs space between its drawings.")
    if count > 16 * MOST_CELLS:
        raise InputError(
            f"it falls into {count - 1} parts; --split auto needs drawings with space around them."
        )
    starts = stats[1:, [cv2.CC_STAT_LEFT, cv2.CC_STAT_TOP]].astype(np.intp)
    sizes = stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].astype(np.intp)
    boxes = np.hstack([starts, starts + sizes])
    owner = _owners(boxes)
    whole = np.flatnonzero(owner == np.arange(len(owner)))
    if len(whole) > MOST_CELLS:
        raise InputError(f"it holds {len(whole)} drawings; a sheet has {MOST_CELLS} at most.")
    cells = []
    for island in whole:
        parts = np.flatnonzero(owner == island)
        left, top = boxes[parts, :2].min(0)
        right, bottom = boxes[parts, 2:].max(0)
        box = np.s_[top:bottom, left:right]
        own = np.isin(labels[box], np.append(parts + 1, 0))
        cells.append(Cell("", int(left), int(top), int(right - left), int(bottom - top), own=own))
    return in_rows([cell for cell in cells if min(cell.width, cell.height) >= SMALLEST])


def drawn(sheet: Decoded) -> BoolMask:
    """Return a sheet's opaque pixels (H, W); if all are opaque, its lines and the area they enclose."""
    opaque = _opaque(sheet)
    return _lines(sheet) if opaque is None else opaque


def _opaque(sheet: Decoded) -> BoolMask | None:
    """Return the opaque pixels (H, W) of a sheet; None if nothing is transparent."""
    pixels = sheet.pixels
    if pixels.ndim != 3 or pixels.shape[2] != 4 or pixels[..., 3].min() == 255:
        return None
    return np.asarray(pixels[..., 3] > _FAINT)


def _lines(sheet: Decoded) -> BoolMask:
    """Return the lines of a sheet and the area they enclose, (H, W)."""
    picture = to_picture(sheet)
    worked = fitted_within(picture.size, MOST_WORKED)
    lines = enclosed_by(clean(picture.resized(worked), read(picture)).ink > INKED)
    return lines if worked == picture.size else resize(lines.astype(np.float32), picture.size) > 0.5


def _owners(boxes: _Boxes) -> NDArray[np.intp]:
    """Return for each part (left, top, right, bottom) the index of the part that it is merged into."""
    spans = (boxes[:, 2:] - boxes[:, :2]).max(1)
    owner = np.arange(len(boxes))
    large = np.flatnonzero(spans >= _SMALL * spans.max())
    for part in np.flatnonzero(spans < _SMALL * spans.max()):
        apart = np.maximum(boxes[large, :2] - boxes[part, 2:], boxes[part, :2] - boxes[large, 2:])
        away = np.hypot(*np.maximum(apart, 0).T)
        nearest = int(np.argmin(away))
        if away[nearest] <= _BESIDE * spans[large[nearest]] or spans[part] < SMALLEST:
            owner[part] = large[nearest]
    # A part inside the box of another, such as an eye in a head, belongs to it.
    for part in large:
        inside = (boxes[large, :2] <= boxes[part, :2]).all(1) & (boxes[large, 2:] >= boxes[part, 2:]).all(1)
        inside &= spans[large] > spans[part]
        if inside.any():
            owner[owner == part] = owner[large[np.flatnonzero(inside)[0]]]
    return owner


def in_rows(cells: list[Cell], noun: str = "drawing") -> list[Cell]:
    """Return cells in reading order, named by ``noun`` and numbered from 1."""
    if not cells:
        raise InputError(f"its drawings are smaller than {SMALLEST} pixels.")
    rows: list[list[Cell]] = []
    for cell in sorted(cells, key=lambda each: each.top):
        middle = cell.top + cell.height / 2
        if rows and middle < max(each.top + each.height for each in rows[-1]):
            rows[-1].append(cell)
        else:
            rows.append([cell])
    ordered = [cell for row in rows for cell in sorted(row, key=lambda each: each.left)]
    return [
        Cell(f"{noun} {number}", each.left, each.top, each.width, each.height, own=each.own)
        for number, each in enumerate(ordered, 1)
    ]
