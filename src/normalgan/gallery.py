"""The gallery: rows of sketch, hints, generated map, ground truth and error, as one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from normalgan.normals import Floats, encode, normalize, paint_flat, write_bytes

COLUMNS = ("sketch", "hints", "generated", "ground truth", "error")
MAX_ERROR = 60.0
"""Degrees at the top of the error scale; larger errors have its last colour."""


@dataclass(frozen=True)
class Row:
    """One sample of the gallery, as numpy arrays.

    Args:
        title: what is written beside it.
        sketch: (H, W) in [0, 1], ink 1.
        hints: (4, H, W) normals at the hints and where they are.
        preds: (3, H, W) generated normals of any length.
        target: (3, H, W) true unit normals, 0 off the object.
        mask: (H, W) True on the object.
    """

    title: str
    sketch: Floats
    hints: Floats
    preds: Floats
    target: Floats
    mask: NDArray[np.bool_]

    def error(self) -> Floats:
        """Return the angular error in degrees, (H, W), nan off the object."""
        preds, target = normalize(np.moveaxis(self.preds, 0, -1)), np.moveaxis(self.target, 0, -1)
        sine = np.linalg.norm(np.cross(preds, target), axis=-1)
        angle = np.rad2deg(np.arctan2(sine, (preds * target).sum(-1)))
        return np.where(self.mask, angle, np.nan).astype(np.float32)


def colours(normal: Floats, mask: NDArray[np.bool_] | None = None) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3) of a map (3, H, W); flat off the object.

    Without a mask, what is shorter than half a unit is taken for background.
    """
    vectors = np.moveaxis(normal, 0, -1)
    if mask is None:
        mask = np.linalg.norm(vectors, axis=-1) > 0.5
    return encode(paint_flat(normalize(vectors), mask)).astype(np.uint8)


def draw_gallery(rows: Sequence[Row], caption: str = "") -> bytes:
    """Return the gallery as a PNG, with a scale of the error in degrees.

    Args:
        rows: the samples, top to bottom.
        caption: one line above them.
    """
    figure = Figure(figsize=(2.0 * len(COLUMNS) + 0.9, 2.0 * len(rows) + 0.7), dpi=110, layout="constrained")
    axes = figure.subplots(len(rows), len(COLUMNS), squeeze=False)
    for name, top in zip(COLUMNS, axes[0], strict=True):
        top.set_title(name, fontsize=10)
    for row, line in zip(rows, axes, strict=True):
        _draw_row(row, line)
    scale = axes[0, -1].images[0]
    figure.colorbar(scale, ax=axes[:, -1], label="angular error in degrees", extend="max", shrink=0.9)
    if caption:
        figure.suptitle(caption, fontsize=10)
    png = BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()


def write_gallery(path: str | Path, rows: Sequence[Row], caption: str = "") -> None:
    """Write the gallery as a PNG file."""
    write_bytes(path, draw_gallery(rows, caption))


def _draw_row(row: Row, axes: Sequence[Axes]) -> None:
    paper = 1 - row.sketch
    axes[0].imshow(paper, cmap="gray", vmin=0, vmax=1)
    axes[0].set_ylabel(row.title, fontsize=8)
    axes[1].imshow(1 - row.sketch * 0.3, cmap="gray", vmin=0, vmax=1)
    y, x = np.nonzero(row.hints[3] > 0.5)
    axes[1].scatter(x, y, s=14, c=encode(row.hints[:3, y, x].T) / 255, edgecolors="black", linewidths=0.3)
    axes[2].imshow(colours(row.preds))
    axes[3].imshow(colours(row.target, row.mask))
    error = row.error()
    axes[4].imshow(error, cmap="magma", vmin=0, vmax=MAX_ERROR)
    axes[4].set_xlabel(f"mean {np.nanmean(error):.1f}°" if row.mask.any() else "no object", fontsize=8)
    for ax in axes:
        ax.set_xticks([])
        ax.set_yticks([])
