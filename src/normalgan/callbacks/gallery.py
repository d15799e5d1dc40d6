"""The gallery: one picture with rows of sketch, hints, generated map, ground truth and error."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
import torch
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray
from torch import Tensor

from normalgan.arrays import BoolMask, Floats
from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.normals import angles, encode, normalize, paint_flat

COLUMNS = ("sketch", "hints", "generated", "ground truth", "angular error")
MAX_ERROR = 60.0
"""Top of the error scale in degrees; larger errors get the last colour."""

_DPI = 100
_EDGE, _GAP, _LINE, _HEAD = 10, 8, 24, 52  # pixels: margin, between cells, caption under a row, headings
_NEUTRAL = (0.72, 0.72, 0.72)  # outside the object, unlike both ends of the error scale


@dataclass(frozen=True)
class Row:
    """One sample of the gallery, as numpy arrays.

    Args:
        title: caption under the row.
        sketch: (H, W) in [0, 1], ink 1.
        hints: (4, H, W): hint normals and hint mask.
        preds: (3, H, W) generated normals of any length.
        target: (3, H, W) true unit normals, 0 outside the object.
        mask: (H, W) True on the object.
    """

    title: str
    sketch: Floats
    hints: Floats
    preds: Floats
    target: Floats
    mask: BoolMask

    def error(self) -> Floats:
        """Return the angular error (H, W) in degrees: nan outside the object, 90° without a prediction."""
        preds, target = normalize(np.moveaxis(self.preds, 0, -1)), np.moveaxis(self.target, 0, -1)
        angle = angles(preds, target)
        angle[~preds.any(-1)] = 90.0  # as in `normalgan.metrics.angular_error`
        return np.where(self.mask, angle, np.nan).astype(np.float32)


def colours(normal: Floats, mask: BoolMask | None = None) -> NDArray[np.uint8]:
    """Return a map (3, H, W) as colours (H, W, 3), flat outside the object.

    Without a mask, vectors shorter than 0.5 count as background.
    """
    vectors = np.moveaxis(normal, 0, -1)
    if mask is None:
        mask = np.linalg.norm(vectors, axis=-1) > 0.5
    return encode(paint_flat(normalize(vectors), mask)).astype(np.uint8)


def batch_row(batch: Batch, index: int, hints: Tensor, preds: Tensor, of_pairs: bool = False) -> Row:
    """Return the gallery row of one sample of a batch.

    Args:
        batch: N samples.
        index: index of the sample.
        hints: (N, 4, H, W), hints given to the generator.
        preds: (N, 3, H, W), predictions of the generator.
        of_pairs: whether samples are pairs on disk, which have a name but no view number.
    """

    def array(tensor: Tensor) -> Tensor:
        return tensor[index].detach().to("cpu", torch.float32)

    mesh, _, view = batch.get("name", [""] * len(preds))[index].rpartition("/")
    return Row(
        title=(mesh if of_pairs else f"{mesh}, view {view}") if mesh else view,
        sketch=array(batch["sketch"])[0].numpy(),
        hints=array(hints).numpy(),
        preds=array(preds).numpy(),
        target=array(batch["normal"]).numpy(),
        mask=array(batch["mask"])[0].numpy() > 0.5,
    )


class Sheet:
    """A matplotlib figure with positions in pixels from the upper left.

    Args:
        width: width in pixels.
        height: height in pixels.
    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)

    def box(self, x: float, y: float, w: float, h: float) -> Axes:
        """Return axes without ticks or frame at a position."""
        place = (x / self.width, 1 - (y + h) / self.height, w / self.width, h / self.height)
        axes = self.figure.add_axes(place)
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
        return axes

    def text(self, x: float, y: float, text: str, **how: Any) -> None:
        """Write text at a position, like `matplotlib.figure.Figure.text`."""
        self.figure.text(x / self.width, 1 - y / self.height, text, **how)

    def error_scale(self, shown: AxesImage, x: float, y: float, w: float, h: float) -> Axes:
        """Draw the colour scale of an error map at a position, and return its axes."""
        scale = self.figure.colorbar(shown, cax=self.box(x, y, w, h), orientation="horizontal")
        scale.outline.set_visible(False)
        scale.set_ticks([0, 15, 30, 45, MAX_ERROR], labels=["0°", "15°", "30°", "45°", f"≥{MAX_ERROR:.0f}°"])
        scale.ax.tick_params(labelsize=8, length=0, pad=2)
        return scale.ax

    def png(self) -> bytes:
        """Return the picture as a PNG."""
        png = BytesIO()
        self.figure.savefig(png, format="png")
        return png.getvalue()


def error_colours() -> Colormap:
    """Return the colour map of error maps, grey outside the object."""
    return colormaps["magma"].with_extremes(bad=_NEUTRAL)


def draw_gallery(rows: Sequence[Row]) -> bytes:
    """Return the gallery as a PNG, with a scale of the error in degrees.

    Maps of up to 300 pixels are enlarged by an integer factor, so that every pixel is visible.

    Args:
        rows: rows from top to bottom, all of the same picture size.

    Raises:
        InputError: if there are no rows.
    """
    if not rows:
        raise InputError("a gallery needs at least one row, but there are no samples to show.")
    size = rows[0].mask.shape[0]
    cell = size * max(1, round(200 / size)) if size <= 300 else 256
    top = _EDGE + _HEAD
    width = 2 * _EDGE + len(COLUMNS) * cell + (len(COLUMNS) - 1) * _GAP
    height = top + len(rows) * (cell + _LINE) + _EDGE
    sheet = Sheet(width, height)
    lefts = [_EDGE + i * (cell + _GAP) for i in range(len(COLUMNS))]
    for i, row in enumerate(rows):
        shown = _draw_row(row, [sheet.box(x, top + i * (cell + _LINE), cell, cell) for x in lefts])
    for name, x in zip(COLUMNS, lefts, strict=True):
        # The scale is placed between the last heading and its column.
        y = top - (_HEAD if name == COLUMNS[-1] else 20)
        sheet.text(x + cell / 2, y, name, fontsize=11, ha="center", va="top")
    scale = sheet.error_scale(shown, lefts[-1], top - 29, cell, 9)
    labels = scale.get_xticklabels()  # the outer labels must not stick out
    labels[0].set_horizontalalignment("left")
    labels[-1].set_horizontalalignment("right")
    return sheet.png()


def _draw_row(row: Row, axes: Sequence[Axes]) -> AxesImage:
    """Draw a row into its axes and return the image of the error map, for the scale."""
    # Enlarged pixels stay square; large maps are downsampled by averaging.
    how = "nearest" if row.mask.shape[0] <= 300 else "antialiased"
    error = row.error()
    axes[0].imshow(1 - row.sketch, cmap="gray", vmin=0, vmax=1, interpolation=how)
    axes[1].imshow(1 - row.sketch * 0.22, cmap="gray", vmin=0, vmax=1, interpolation=how)
    axes[2].imshow(colours(row.preds), interpolation=how)
    axes[3].imshow(colours(row.target, row.mask), interpolation=how)
    shown = axes[4].imshow(error, cmap=error_colours(), vmin=0, vmax=MAX_ERROR, interpolation=how)
    y, x = np.nonzero(row.hints[3] > 0.5)
    dot = 42 if len(x) <= 40 else 18
    axes[1].scatter(
        x, y, s=dot, c=encode(row.hints[:3, y, x].T) / 255, edgecolors="black", linewidths=0.8, clip_on=False
    )
    for frame in axes[:2]:
        frame.spines[:].set(visible=True, color="0.85")
    captions = {
        0: row.title,
        1: f"{len(x) or 'no'} hint{'s' * (len(x) != 1)}",
        4: f"mean {np.nanmean(error):.1f}°" if row.mask.any() else "no object",
    }
    for column, text in captions.items():
        axes[column].set_xlabel(text, fontsize=9, labelpad=3)
    return shown
