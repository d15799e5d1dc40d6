"""Windows: predict a repeating drawing in overlapping windows."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, floor

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.framing import Frame, bounds_of
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.network.tile import Tile, repeats
from normalgan.inference.reading.hint_files import Hints

_SIDE = 1.5
"""Side of a window, as a fraction of the drawing's longer side."""
_IN = 6
"""Minimum number of windows that cover a pixel along each repeating direction; half as many are too few."""


@dataclass(frozen=True)
class Window:
    """A window of a repeating drawing.

    Args:
        corner: first row and column of the window in pixels of the drawing.
        ink: (h, w), the lines in the window.
        frame: the square of the window that is the network's input.
    """

    corner: tuple[int, int]
    ink: Floats
    frame: Frame

    def weight(self, tile: Tile) -> Floats:
        """Return the weight (size, size) of each pixel of the network; 0 at edges that repeat."""
        hills = []
        for first, extent, there in zip(_corner(self.frame), self.ink.shape, repeats(tile), strict=True):
            place = (first + (np.arange(self.frame.size) + 0.5) * _pixel(self.frame)) / extent
            hill = np.sin(np.pi * place) ** 2 if there else np.ones_like(place)
            hills.append(np.where((place > 0) & (place < 1), hill, 0))
        return np.outer(*hills).astype(np.float32)


def windows(ink: Floats, tile: Tile, size: int) -> list[Window]:
    """Return the windows of a repeating drawing (H, W) for a network with an input of ``size`` pixels.

    The windows overlap, so that the prediction hardly depends on where the edges of the drawing lie.
    """
    top, bottom, left, right = bounds_of(ink)
    down, across = repeats(tile)
    own = [extent for extent, there in zip(ink.shape, (down, across), strict=True) if there]
    side = max(round(_SIDE * max(own)), 0 if down else bottom - top, 0 if across else right - left)
    rows = (0, side) if down else (top, bottom)
    columns = (0, side) if across else (left, right)
    found = []
    for corner in product(_steps(ink.shape[0], side, down), _steps(ink.shape[1], side, across)):
        part = ink
        for axis, there in enumerate((down, across)):
            if there:
                part = part.take(range(corner[axis], corner[axis] + side), axis, mode="wrap")
        found.append(Window(corner, part, Frame.about((*rows, *columns), part.shape, size)))
    return found


def predict_windows(
    backend: Backend,
    shown: Sequence[Window],
    frame: Frame,
    tile: Tile,
    shape: tuple[int, int],
    origin: tuple[int, int],
    hints: Hints | None = None,
) -> tuple[Floats, Floats | None]:
    """Return the merged predictions in windows; like `Backend.predict`, but for ``frame``.

    Args:
        backend: the network.
        shown: the windows.
        frame: frame of the result, in a picture that contains the drawing and some of its repeats.
        tile: directions in which the drawing repeats.
        shape: (H, W) of the drawing.
        origin: row and column of the drawing's first pixel in that picture.
        hints: hints in pixels of the drawing, or None.
    """
    total: Floats = np.zeros((frame.size, frame.size, 5), np.float32)
    sure = False
    for each in shown:
        own = None
        if hints is not None:
            near = repeated(hints, tile, shape, each.corner, each.ink.shape)
            own = each.frame.cut_points(near.points, near.normals)
        normals, confidence = backend.predict(
            render_model_input(each.ink, each.frame, backend.line_widths), own
        )
        sure = confidence is not None
        weight = each.weight(tile)
        values = np.dstack([normals, np.zeros_like(weight) if confidence is None else confidence])
        values = np.dstack([values * weight[..., None], weight])
        first = np.array([_corner(each.frame), each.corner, origin], np.intp).sum(0)
        ratio = _pixel(frame) / _pixel(each.frame)
        for shift in _shifts(tile, shape, first, round(each.frame.side), frame.shape):
            # This maps pixel centres of the frame to pixel centres of the window.
            row, column = (np.array(_corner(frame)) - first - shift) / _pixel(each.frame) + (ratio - 1) / 2
            there = np.array([[ratio, 0, column], [0, ratio, row]])
            flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            total += cv2.warpAffine(values, there, (frame.size, frame.size), flags=flags)
    total[..., :4] /= np.maximum(total[..., 4:], 1e-6)
    return np.ascontiguousarray(total[..., :3]), total[..., 3] if sure else None


def repeated(
    hints: Hints, tile: Tile, shape: tuple[int, int], corner: tuple[int, int], extent: Sequence[int]
) -> Hints:
    """Return the hints and their repeats in a part of a repeating drawing, in pixels of the part.

    Args:
        hints: hints in pixels of the drawing.
        tile: directions in which the drawing repeats.
        shape: (H, W) of the drawing.
        corner: first row and column of the part in pixels of the drawing.
        extent: numbers of rows and columns of the part.
    """
    away: NDArray[np.intp] = np.array(corner, np.intp)
    found = [
        hints.points + (shift - away)[::-1].astype(np.float32)
        for shift in _shifts(tile, shape, -away, max(shape), extent)
    ]
    points, normals = np.concatenate(found), np.tile(hints.normals, (len(found), 1))
    inside = ((points >= 0) & (points < np.array(extent[::-1]))).all(1)
    return Hints(points[inside], normals[inside])


def _shifts(
    tile: Tile, shape: tuple[int, int], first: NDArray[np.intp], side: int, extent: Sequence[int]
) -> Iterator[NDArray[np.intp]]:
    """Yield the offsets (down, right) of the repeats of a square that overlap a picture."""
    every = []
    for period, begin, length, there in zip(shape, first, extent, repeats(tile), strict=True):
        least, most = floor((-begin - side) / period) + 1, ceil((length - begin) / period)
        every.append([n * period for n in (range(least, most) if there else (0,))])
    for shift in product(*every):
        yield np.array(shift)


def _steps(extent: int, side: int, there: bool) -> Sequence[int]:
    """Return the first row or column of each window along one direction."""
    count = ceil(_IN * extent / side)
    return [round(i * extent / count) for i in range(count)] if there else (0,)


def _corner(frame: Frame) -> tuple[int, int]:
    return round(frame.top), round(frame.left)


def _pixel(frame: Frame) -> float:
    """Return the side of a network pixel in pixels of the drawing."""
    return round(frame.side) / frame.size
