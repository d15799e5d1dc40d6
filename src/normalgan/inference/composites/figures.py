"""Figures: find the separate objects of a page."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.decoding import Decoded
from normalgan.graphs import connected
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.islands import find_islands, in_rows
from normalgan.inference.mask.decision import Decision
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.drawings import SMALLEST
from normalgan.inference.regions import INKED

_ALIKE = 0.25
"""Minimum area of a figure, as a fraction of the largest figure's; smaller areas join their neighbour."""
_OWN_MIDDLE = 0.35
"""Maximum distance of the predicted object centre from the centre of the box, as a fraction of its span."""
_ROOM = 0.04
"""Margin around a figure, as a fraction of its span."""
_LEAST = 0.4
"""Minimum mean presence of a figure."""


def figures_of(prepared: Prepared, pixels: Callable[[], Decoded] | None) -> list[Cell]:
    """Return the cells of a page's figures in pixels of the map; empty for a single object.

    Args:
        prepared: the page, from `prepare`.
        pixels: returns its pixels; None if the map has another size, because islands are found in pixels of
            the drawing.
    """
    if prepared.alpha is not None and prepared.mask is not None:
        if pixels is None or cv2.connectedComponents(prepared.mask.view(np.uint8))[0] < 3:
            return []
        islands = find_islands(pixels())
        return islands if alike(islands) else []
    if prepared.decision is None or prepared.reading is None:
        return []
    return find_figures(prepared.decision, prepared.reading, prepared.shape)


def find_figures(decision: Decision, reading: Reading, shape: tuple[int, int]) -> list[Cell]:
    """Return the cells of a page's figures in reading order; empty if the page shows a single object.

    Areas connected by a line are one figure. The reader predicts the centre of each pixel's object; if an
    area's predicted centre lies outside it, the area is part of a larger object.

    Args:
        decision: the mask decision for the whole page.
        reading: the reader's output for the whole page.
        shape: (H, W) of the drawing; the cells are in pixels of it.
    """
    size = decision.voted.shape[0], decision.voted.shape[1]
    presence = reading.presence_at(size)
    # Lines count as body, so that areas connected by a line are one.
    body = (presence > 0.5) | (decision.ink > INKED)
    count, found, measured, _ = cv2.connectedComponentsWithStats(body.astype(np.uint8), connectivity=8)
    labels, stats = np.asarray(found, np.int32), np.asarray(measured, np.int32)
    areas = stats[:, cv2.CC_STAT_AREA].astype(np.float64)
    areas[0] = 0
    large = np.flatnonzero(areas > _ALIKE * areas.max(initial=0))
    means = np.bincount(labels.ravel(), weights=presence.ravel(), minlength=count) / np.maximum(areas, 1)
    large = large[means[large] > _LEAST]
    if len(large) < 2:
        return []
    owner = np.full(count, -1)
    owner[large] = np.arange(len(large))
    figure = owner[labels]
    boxes = stats[large][:, [cv2.CC_STAT_LEFT, cv2.CC_STAT_TOP, cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
    groups = connected(len(large), _strangers(figure, boxes, reading, size))
    count = int(groups.max()) + 1
    return _cells(np.append(groups, -1)[figure], body, count, shape) if count > 1 else []


def _strangers(
    figure: NDArray[np.intp], boxes: NDArray[np.int32], reading: Reading, size: tuple[int, int]
) -> list[tuple[int, int]]:
    """Return pairs of areas that belong to one object.

    The first area of a pair has its predicted centre outside itself; the second is the one nearest to that
    centre.
    """
    seen = [cv2.resize(each, size[::-1], interpolation=cv2.INTER_LINEAR) for each in reading.middle]
    there = figure >= 0
    counts = np.bincount(figure[there], minlength=len(boxes))
    found = np.stack(
        [
            np.bincount(figure[there], weights=each[there], minlength=len(boxes)) / counts * side
            for each, side in zip(seen, size[::-1], strict=True)
        ],
        axis=-1,
    )
    own = boxes[:, :2] + boxes[:, 2:] / 2
    spans = boxes[:, 2:].max(1)
    off = np.hypot(*(found - own).T) / spans
    pairs = []
    for each in np.flatnonzero(off > _OWN_MIDDLE):
        away = np.maximum(boxes[:, :2] - found[each], found[each] - boxes[:, :2] - boxes[:, 2:]).max(1)
        away[each] = np.inf
        pairs.append((int(each), int(away.argmin())))
    return pairs


def _cells(figure: NDArray[np.intp], drawn: BoolMask, count: int, shape: tuple[int, int]) -> list[Cell]:
    """Return a cell for each figure: its box, restricted to the pixels for which it is the nearest figure.

    Args:
        figure: (h, w), index of each pixel's figure, -1 for none.
        drawn: (h, w), lines and bodies.
        count: number of figures.
        shape: (H, W) of the drawing.
    """
    free = (figure < 0).astype(np.uint8)
    _, nearest = cv2.distanceTransformWithLabels(free, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    name_of = np.zeros(int(nearest.max()) + 1, np.intp)
    name_of[nearest[free == 0]] = figure[free == 0]
    owner = name_of[nearest]
    whole = cv2.resize(owner.astype(np.int32), shape[::-1], interpolation=cv2.INTER_NEAREST)
    scale = np.array([shape[0] / figure.shape[0], shape[1] / figure.shape[1]], np.float64)
    cells = []
    for number in range(count):
        rows, columns = np.nonzero((owner == number) & drawn)
        low = np.array([rows.min(), columns.min()]) * scale
        high = (np.array([rows.max(), columns.max()]) + 1) * scale
        room = _ROOM * float((high - low).max()) + 2
        top, left = (max(int(each - room), 0) for each in low)
        bottom, right = (min(int(each + room) + 1, side) for each, side in zip(high, shape, strict=True))
        own = whole[top:bottom, left:right] == number
        if min(own.shape) >= SMALLEST:
            cells.append(Cell("", left, top, right - left, bottom - top, own=own))
    return in_rows(cells, "figure")


def alike(cells: list[Cell]) -> bool:
    """Return whether the islands of a page look like separate figures: at least two are of similar size."""
    areas: Floats = np.array([float(c.own.sum()) if c.own is not None else c.width * c.height for c in cells])
    return int((areas > _ALIKE * areas.max(initial=0)).sum()) > 1
