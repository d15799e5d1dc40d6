"""Figures: find the separate figures of a page, and the outline of each."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.errors import InputError
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.figures import figures_of
from normalgan.inference.findings import Finding
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.picture import Picture, to_pixels
from normalgan.studio.drawings.limits import MOST_LAYERS

_DETAIL = 1.5
"""Maximum distance of an outline from its cell in pixels of the map; cells end midway between two figures."""

_Outline = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class FiguresFinding(Finding):
    """The finding that a page shows separate figures.

    Args:
        outlines: of each figure, one or more lines around it: x, y, x, y, … in pixels of the drawing; empty
            if there are more figures than a drawing can have layers.
    """

    outlines: tuple[_Outline, ...] = ()


def several_figures(prepared: Prepared, picture: Picture) -> tuple[Finding, ...]:
    """Return the finding about separate figures, which `normalgan generate` would predict separately.

    A picture with opacity needs its own pixels for that, so a map of another size has no such finding.
    """
    own = prepared.shape == picture.shape
    try:
        cells = figures_of(prepared, (lambda: to_pixels(picture)) if own else None)
    except InputError:  # too many islands; as one object it can still be predicted
        return ()
    if not cells:
        return ()
    scale = picture.shape[1] / prepared.shape[1]
    centres = ((each.left + each.width / 2, each.top + each.height / 2) for each in cells)
    places = tuple((scale * x, scale * y) for x, y in centres)
    outlines = tuple(_outline(each, scale) for each in cells) if len(cells) <= MOST_LAYERS else ()
    return (FiguresFinding("figures", places, len(places), outlines=outlines),)


def _outline(cell: Cell, scale: float) -> _Outline:
    own = np.ones((cell.height, cell.width), np.uint8) if cell.own is None else cell.own.astype(np.uint8)
    # One pixel wider, because the contour runs through the middles of the outermost pixels.
    wide = cv2.dilate(np.pad(own, 1), np.ones((3, 3), np.uint8))
    contours, _ = cv2.findContours(wide, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    corner = np.array([cell.left - 0.5, cell.top - 0.5])
    return tuple(
        tuple(int(each) for each in np.rint(scale * (np.asarray(line).reshape(-1, 2) + corner)).ravel())
        for line in (cv2.approxPolyDP(contour, _DETAIL, closed=True) for contour in contours)
        if len(line) > 2
    )
