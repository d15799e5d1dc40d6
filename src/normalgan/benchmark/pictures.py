"""The gallery of a benchmark: a few test samples with the map and error of every method."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from textwrap import fill

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from normalgan.callbacks.gallery import MAX_ERROR, Row, colours
from normalgan.normals import encode

__all__ = ["Line", "Picture", "draw_methods"]

_CELL, _GAP, _HEAD, _LABEL, _DPI = 112, 4, 40, 190, 100  # pixels
_NEUTRAL = (0.72, 0.72, 0.72)  # off the object, as in `normalgan.callbacks.gallery`

Picture = NDArray[np.generic]


@dataclass(frozen=True)
class Line:
    """What one method predicts of the samples.

    Args:
        label: of the method.
        rows: the samples, in the same order for every method.
    """

    label: str
    rows: Sequence[Row]


def draw_methods(lines: Sequence[Line], caption: str) -> bytes:
    """Return the picture as a PNG: two columns a sample (map, error), a line a method, the truth above.

    Args:
        lines: the methods, top to bottom; at least one.
        caption: above all.
    """
    samples = lines[0].rows
    magma = colormaps["magma"].with_extremes(bad=_NEUTRAL)  # has no say in pictures of colours
    width = _LABEL + len(samples) * 2 * (_CELL + _GAP) + 3 * _GAP * len(samples)
    height = 2 * _HEAD + (len(lines) + 1) * (_CELL + _GAP)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)

    def show(picture: Picture, line: int, column: int, text: str = "") -> AxesImage:
        x = _LABEL + column * (_CELL + _GAP) + column // 2 * 3 * _GAP
        y = _HEAD + line * (_CELL + _GAP)
        axes = figure.add_axes((x / width, 1 - (y + _CELL) / height, _CELL / width, _CELL / height))
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
        if text:
            box = {"facecolor": (1, 1, 1, 0.65), "edgecolor": "none", "pad": 1.5}
            axes.text(0.04, 0.04, text, transform=axes.transAxes, fontsize=8, va="bottom", bbox=box)
        return axes.imshow(picture, interpolation="antialiased", cmap=magma, vmin=0, vmax=MAX_ERROR)

    def name(text: str, line: int) -> None:
        y = _HEAD + line * (_CELL + _GAP) + _CELL / 2
        x, y = (_LABEL - 10) / width, 1 - y / height
        wrapped = fill(text, 24)  # more letters of this size may not fit beside the pictures
        figure.text(x, y, wrapped, ha="right", va="center", fontsize=9)

    figure.text(0.01, 1 - 8 / height, caption, fontsize=10, va="top")
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
    bar = figure.add_axes((_LABEL / width, 26 / height, 2 * _CELL / width, 8 / height))
    scale = figure.colorbar(shown, cax=bar, orientation="horizontal")
    scale.outline.set_visible(False)
    scale.set_ticks([0, 15, 30, 45, MAX_ERROR], labels=["0°", "15°", "30°", "45°", f"≥{MAX_ERROR:.0f}°"])
    bar.tick_params(labelsize=8, length=0, pad=2)
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


def _hinted(row: Row) -> NDArray[np.uint8]:
    """Return the sketch (H, W, 3) with dots of the hints' colours in it."""
    picture = np.repeat((255 * (1 - row.sketch))[..., None], 3, axis=-1)
    reach = max(1, round(row.mask.shape[0] / 90))
    for y, x in np.argwhere(row.hints[3] > 0.5):
        colour = encode(row.hints[:3, y, x])
        picture[max(y - reach, 0) : y + reach + 1, max(x - reach, 0) : x + reach + 1] = colour
    return picture.astype(np.uint8)
