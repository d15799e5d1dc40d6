"""Overlaps: assign each drawn pixel of a sheet to one of the sprites whose boxes overlap there."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.decoding import Decoded
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.islands import drawn

_HALF = 0.5
"""Fraction of a connected part that a box must hold to show the part itself, not just a neighbour's edge."""


def separate(cells: Sequence[Cell], sheet: Decoded) -> tuple[list[Cell], list[str]]:
    """Return cells that do not share any drawn pixel.

    Packers let the boxes of sprites overlap where their corners are empty. A connected part of the drawing
    belongs to the box that holds most of it; of two boxes that hold the same amount, to the smaller one.

    Args:
        cells: boxes in the sheet, which may overlap.
        sheet: pixels of the sheet, not reduced.

    Returns:
        The cells in the given order, overlapping ones with their own pixels marked, and a warning for each
        pair that shows the same part.
    """
    counts = np.zeros(sheet.pixels.shape[:2], np.uint16)
    for cell in cells:
        counts[cell.box] += 1
    if counts.max(initial=0) <= 1:
        return list(cells), []
    crowded = [i for i, cell in enumerate(cells) if (counts[cell.box] > 1).any()]
    crowded.sort(key=lambda i: cells[i].width * cells[i].height)
    found = cv2.connectedComponents(drawn(sheet).astype(np.uint8), connectivity=8)[1]
    labels = np.asarray(found, np.int32)
    sizes = np.bincount(labels.ravel())
    best, owner = np.zeros(labels.shape, np.float32), np.full(labels.shape, -1, np.int32)
    for i in crowded:
        share = _share(labels[cells[i].box], sizes)
        more = share > best[cells[i].box] + np.float32(1e-6)
        best[cells[i].box][more], owner[cells[i].box][more] = share[more], i
    separated, warnings = list(cells), []
    for i in sorted(crowded):
        box = cells[i].box
        other = (labels[box] > 0) & (owner[box] != i)
        separated[i] = replace(cells[i], own=~other)
        shown = other & (_share(labels[box], sizes) >= _HALF)
        if not ((labels[box] > 0) & ~other).any():
            shown = other  # the box shows only a detail of another sprite
        if shown.any():
            first = cells[int(owner[box][shown][0])]
            warnings.append(
                f"{cells[i].name!r} and {first.name!r} show the same part of the sheet; it is predicted as "
                f"{first.name!r}"
            )
    return separated, warnings


def _share(labels: NDArray[np.int32], sizes: NDArray[np.intp]) -> Floats:
    """Return the fraction (h, w) of each pixel's connected part that lies in the box; 0 off all parts."""
    found, where, counts = np.unique(labels, return_inverse=True, return_counts=True)
    share = np.where(found > 0, counts / sizes[found], 0).astype(np.float32)
    return np.asarray(share[where].reshape(labels.shape))
