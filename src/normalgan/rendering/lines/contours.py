"""Contours: outlines, occluding edges and creases, and the styles that draw them."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats, Indices
from normalgan.ranges import NonNegative, Positive, Range
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import BufferedDrawing, Buffers, Sight
from normalgan.rendering.lines.crossings import PAIRS, Crossed, Crossings, Line, crossings, places
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.curves import SPACING, resample, settle, smooth
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class OccludingContours(BufferedDrawing):
    """Silhouette and occluding contours, and optionally the creases of angular objects.

    Args:
        gap: minimum depth discontinuity at a contour, beyond the change explained by the slope, as a
            fraction of the frame's side. A contour continues as long as it reaches a third of this.
        crease: minimum angle in degrees between neighbouring normals at a crease; None draws no creases.
        shortest: minimum extent of a contour, as a fraction of the frame's side.
    """

    gap: Positive = 0.01
    crease: Annotated[float, Range(0, 180, above=True, below=True)] | None = None
    shortest: NonNegative = 0.012

    def _draw(self, view: View, buffers: Buffers) -> list[Stroke]:
        lines = occluding_contours(buffers, self.gap, self.shortest)
        if self.crease is not None:
            lines += _creases(buffers.maps, self.crease).lines(0, self.shortest * buffers.side)
        return [_draw_border(line, buffers, self.line_width) for line in lines]


def occluding_contours(buffers: Buffers, gap: float, shortest: float) -> list[Line]:
    """Return the occluding contours, given lengths as fractions of the frame's side."""
    gap *= buffers.side
    return _depth_gaps(buffers.maps, buffers.sight, gap / 3).lines(gap, shortest * buffers.side)


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class Silhouette(BufferedDrawing):
    """Only the outline, where the object borders on the background, including holes.

    Args:
        shortest: minimum extent of a part of the outline, as a fraction of the frame's side.
    """

    shortest: NonNegative = 0.05

    def _draw(self, view: View, buffers: Buffers) -> list[Stroke]:
        lines = borders(buffers.maps.mask).lines(0, self.shortest * buffers.side)
        return [_draw_border(line, buffers, self.line_width) for line in lines]


def borders(mask: BoolMask) -> Crossings:
    """Return the border of a mask (H, W), except along the border of the frame."""
    pairs: list[Crossed] = []
    for one, two in PAIRS:
        row, column = np.nonzero(mask[one] != mask[two])
        second = mask[two][row, column]
        count = len(row)
        pairs.append((row, column, np.full(count, 0.5), np.ones(count, np.float32), second))
    return crossings((pairs[0], pairs[1]), mask.shape[1])


@dataclass(frozen=True)
class OutlinedDrawing(BufferedDrawing):
    """Base class of styles that draw occluding contours and specific inner strokes.

    Args:
        line_width: width of contours in pixels of the sketch, at any sketch size.
        interior_width: width of inner strokes in pixels of the sketch; 0 draws none.
        gap: minimum depth discontinuity at a contour, beyond the change explained by the slope, as a
            fraction of the frame's side.
        shortest_contour: minimum extent of a contour, as a fraction of the frame's side.
        shortest: minimum length of an inner stroke, as a fraction of the frame's side.
        apart: minimum mean distance of an inner stroke to contours, as a fraction of the frame's side;
            closer strokes would only duplicate a contour.
    """

    interior_width: NonNegative = 0.9
    gap: Positive = 0.01
    shortest_contour: NonNegative = 0.012
    shortest: NonNegative = 0.045
    apart: NonNegative = 0.012

    def _draw(self, view: View, buffers: Buffers) -> list[Stroke]:
        contours = occluding_contours(buffers, self.gap, self.shortest_contour)
        strokes = [_draw_border(line, buffers, self.line_width) for line in contours]
        if self.interior_width > 0:
            distance = _distance_to(mark(contours, buffers.maps.mask.shape))
            strokes += self._draw_inside(view, buffers, distance)
        return strokes

    @abstractmethod
    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the inner strokes.

        Args:
            view: view of the object.
            buffers: maps in which the contours were found.
            distance: (H, W) distance of each pixel of the buffers to the nearest contour, in pixels.
        """


def mark(lines: Sequence[Line], shape: tuple[int, ...]) -> BoolMask:
    """Return a mask of the given shape with the pixels of lines."""
    marks = np.zeros(shape, bool)
    for line in lines:
        marks[tuple(line.pixels.T)] = True
    return marks


def _distance_to(marks: BoolMask) -> Floats:
    """Return the distance in pixels from each pixel to the nearest marked one; huge if there is none.

    It is a chamfer distance with a 5 × 5 mask, within 2 % of the Euclidean distance at a fraction of the
    cost.
    """
    if not marks.any():
        return np.full(marks.shape, np.finfo(np.float32).max, np.float32)
    distance = cv2.distanceTransform((~marks).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return distance.astype(np.float32, copy=False)


_COARSE_SMOOTHING = 4.0  # points for smoothing a line that is only known to pass between two pixels
_SLACK = 0.5  # pixels from the border of two pixels to their centres, between which the line passes
_FINE_SMOOTHING = 1.5  # points for smoothing a more precise line


def _draw_border(line: Line, buffers: Buffers, width: float) -> Stroke:
    """Return the stroke along a line that is only known to pass between certain pixels."""
    path = settle(line.points, _COARSE_SMOOTHING, _SLACK)
    return Stroke.even(resample(buffers.to_sketch(path), SPACING), width)


def draw_curve(line: Line, buffers: Buffers, width: float) -> Stroke:
    """Return the stroke along a line with subpixel points."""
    path = smooth(line.points, _FINE_SMOOTHING)
    return Stroke.even(resample(buffers.to_sketch(path), SPACING), width)


_GRAZING = 0.1  # minimum cosine of a tangent plane, because steeper planes would explain any gap
_BAND = 2  # pixels; such a narrow flank is a contour, because it is thinner than the line
_MUCH_LARGER = 3.0  # ratio above which a gap is considered much larger
_BACKGROUND_DEPTH = np.float32(1e6)  # depth of the background in mesh units, farther than any object


def _depth_gaps(maps: Maps, sight: Sight, least: float) -> Crossings:
    """Return the depth discontinuities of at least ``least`` > 0 pixel sizes between neighbouring pixels.

    The expected depth change between neighbours is in the range of the predictions of both tangent planes
    and the changes a few pixels away on either side. Only an excess over it is a gap. Surfaces at a
    grazing angle therefore get no ink, even if the interpolated normals of a coarse mesh look less steep.
    A gap belongs to the nearer, occluding pixel. Its strength is its size, and is huge next to the
    background. The frame's border does not count as a gap.
    """
    depth = np.where(maps.mask, maps.depth, _BACKGROUND_DEPTH)
    floor = np.where(maps.mask, sight.pixel, np.float32(0)) * np.float32(least)
    right, below = (_gaps_along(axis, depth, floor, maps, sight) for axis in (0, 1))
    return crossings((right, below), maps.mask.shape[1])


def _gaps_along(axis: int, depth: Floats, floor: Floats, maps: Maps, sight: Sight) -> Crossed:
    """Return the gaps between each pixel and its right (axis 0) or lower (axis 1) neighbour."""
    one, two = PAIRS[axis]
    # Only a few pairs of pixels need the full check.
    rows, columns = places(np.abs(depth[two] - depth[one]) > np.maximum(floor[one], floor[two]))
    # Pixels in a row: the pair, and another pair on each side of it.
    ahead = (-_BAND, 1 - _BAND, 0, 1, _BAND, _BAND + 1)
    line = [_moved(rows, columns, k, axis, depth.shape) for k in ahead]
    deep = [depth.ravel()[pixel] for pixel in line]
    step = deep[3] - deep[2]
    excuses = [deep[1] - deep[0], deep[5] - deep[4]]
    excuses = [np.where(np.abs(excuse) < _BACKGROUND_DEPTH / 2, excuse, 0) for excuse in excuses]
    excuses += [_foretold(maps, sight, pixel, axis) for pixel in line[2:4]]
    back, front = step - np.max(excuses, axis=0), np.min(excuses, axis=0) - step
    second = front > back
    nearer = np.where(second, line[3], line[2])
    gap, size = np.maximum(back, front), sight.pixel.ravel()[nearer]
    # Outside the object, pixels have no size, and nothing is hidden.
    seen = np.flatnonzero(maps.mask.ravel()[nearer] & (gap > floor.ravel()[nearer]))
    strength, second, first = gap[seen] / size[seen], second[seen], line[2][seen]
    # A strong edge is a contour, even close to the end of the part behind it.
    weak = gap[seen] < _MUCH_LARGER * floor.ravel()[nearer[seen]]
    kept = seen[~(weak & _outdone(np.where(second, -strength, strength), first, depth.shape, axis))]
    second, fraction = front[kept] > back[kept], np.full(len(kept), 0.5)
    return rows[kept], columns[kept], fraction, gap[kept] / size[kept], second


def _moved(rows: Indices, columns: Indices, by: int, axis: int, shape: tuple[int, ...]) -> Indices:
    """Return flat indices of pixels shifted right (axis 0) or down (axis 1), clamped to the picture."""
    if axis:
        rows = (rows + by).clip(0, shape[0] - 1)
    else:
        columns = (columns + by).clip(0, shape[1] - 1)
    return rows * shape[1] + columns


def _foretold(maps: Maps, sight: Sight, pixel: Indices, axis: int) -> Floats:
    """Return the depth change of each pixel's tangent plane to the right (axis 0) or downwards (axis 1)."""
    nx, ny, nz = maps.normal.reshape(-1, 3).take(pixel, axis=0).T
    row, column = np.divmod(pixel, maps.mask.shape[1])
    towards = nz - nx * sight.x[column] - ny * sight.y[row]
    across = -ny if axis else nx  # the lower pixel is towards -y
    slope: Floats = across * sight.pixel.ravel()[pixel] / np.maximum(towards, _GRAZING)
    return slope


def _outdone(falls: Floats, first: Indices, shape: tuple[int, ...], axis: int) -> BoolMask:
    """Return which discontinuities may be just the start or end of a much larger neighbour in their row.

    Args:
        falls: (N,) depth discontinuities, positive away from the viewer.
        first: (N,) flat index of the first pixel of each pair.
        shape: (H, W) of the picture.
        axis: 0 for horizontal pairs, 1 for vertical pairs.
    """
    stride = shape[1] if axis else 1
    there = np.zeros(shape[0] * shape[1] + 2 * stride, np.float32)
    there[first + stride] = falls
    sign = np.sign(falls)
    beside = [there[first + k * stride] * sign for k in (0, 2)]
    outdone: BoolMask = np.max(beside, axis=0) > _MUCH_LARGER * np.abs(falls)
    return outdone


def _creases(maps: Maps, angle: float) -> Crossings:
    """Return where normals of neighbouring object pixels differ by at least ``angle`` degrees.

    If this is the case for several pixels in a row, the largest difference counts.
    """
    limit = np.cos(np.deg2rad(angle))
    pairs = []
    for axis, (one, two) in enumerate(PAIRS):
        cosine = np.einsum("ijk,ijk->ij", maps.normal[one], maps.normal[two])
        cosine[~(maps.mask[one] & maps.mask[two])] = 1
        sharpest = (cosine < limit) & _lowest(cosine, 1 - axis)
        rows, columns = np.nonzero(sharpest)
        fraction, second = np.full(len(rows), 0.5), np.zeros(len(rows), bool)
        pairs.append((rows, columns, fraction, 1 - cosine[sharpest], second))
    return crossings((pairs[0], pairs[1]), maps.mask.shape[1])


def _lowest(values: Floats, axis: int) -> BoolMask:
    """Return which values (H, W) are below the previous and not above the next value along an axis."""
    padding = [(1, 1) if k == axis else (0, 0) for k in (0, 1)]
    padded = np.pad(values, padding, constant_values=np.inf)
    length = values.shape[axis]
    before, after = (padded.take(np.arange(k, k + length), axis) for k in (0, 2))
    return (values < before) & (values <= after)
