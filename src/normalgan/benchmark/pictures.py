"""Gallery of a benchmark: draw a few test samples with the map and error of every method."""

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import fill

import numpy as np
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from normalgan.callbacks.gallery import MAX_ERROR, Row, Sheet, colours, error_colours
from normalgan.normals import encode

_CELL, _GAP, _HEAD, _LABEL = 112, 4, 40, 190  # pixels

Picture = NDArray[np.generic]


@dataclass(frozen=True)
class Line:
    """The label and predictions of one method; the samples are in the same order for all methods."""

    label: str
    rows: Sequence[Row]


def draw_methods(lines: Sequence[Line], caption: str) -> bytes:
    """Return the gallery as a PNG: two columns per sample (map, error), the truth, and a row per method."""
    samples = lines[0].rows
    width = _LABEL + len(samples) * 2 * (_CELL + _GAP) + 3 * _GAP * len(samples)
    height = 2 * _HEAD + (len(lines) + 1) * (_CELL + _GAP)
    sheet = Sheet(width, height)

    def show(picture: Picture, line: int, column: int, text: str = "") -> AxesImage:
        x = _LABEL + column * (_CELL + _GAP) + column // 2 * 3 * _GAP
        y = _HEAD + line * (_CELL + _GAP)
        axes = sheet.box(x, y, _CELL, _CELL)
        if text:
            box = {"facecolor": (1, 1, 1, 0.65), "edgecolor": "none", "pad": 1.5}
            axes.text(0.04, 0.04, text, transform=axes.transAxes, fontsize=8, va="bottom", bbox=box)
        return axes.imshow(picture, interpolation="antialiased", cmap=error_colours(), vmin=0, vmax=MAX_ERROR)

    def name(text: str, line: int) -> None:
        y = _HEAD + line * (_CELL + _GAP) + _CELL / 2
        # Longer labels would not fit next to the pictures.
        sheet.text(_LABEL - 10, y, fill(text, 24), ha="right", va="center", fontsize=9)

    sheet.text(0.01 * width, 8, caption, fontsize=10, va="top")
    name("sketch with hints, truth", 0)
    for i, row in enumerate(samples):
        show(_hinted(row), 0, 2 * i)
        show(colours(row.target, row.mask), 0, 2 * i + 1)
    for number, line in enumerate(lines, 1):
        name(line.label, number)
        for i, row in enumerate(line.rows):
            show(colours(row.preds), number, 2 * i)
            error = row.error()
            text = f"{np.nanmean(error):.1f}°" if row.mask.any() else ""
            shown = show(error, number, 2 * i + 1, text)
    sheet.error_scale(shown, _LABEL, height - 34, 2 * _CELL, 8)
    return sheet.png()


def _hinted(row: Row) -> NDArray[np.uint8]:
    """Return the sketch (H, W, 3) with coloured dots at the hints."""
    picture = np.repeat((255 * (1 - row.sketch))[..., None], 3, axis=-1)
    reach = max(1, round(row.mask.shape[0] / 90))
    for y, x in np.argwhere(row.hints[3] > 0.5):
        colour = encode(row.hints[:3, y, x])
        picture[max(y - reach, 0) : y + reach + 1, max(x - reach, 0) : x + reach + 1] = colour
    return picture.astype(np.uint8)
