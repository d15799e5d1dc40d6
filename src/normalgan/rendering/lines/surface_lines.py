"""Lines on a mesh: crossings of its edges, joined into long strokes that fade."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.ranges import NonNegative, Positive
from normalgan.rendering.cameras import project, towards_eye
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.contours import OutlinedDrawing
from normalgan.rendering.lines.surface import MeshSurface, SurfaceShape, shape_of
from normalgan.rendering.strokes.chain import chain
from normalgan.rendering.strokes.curves import SPACING, lengths_along, resample, smooth
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

_DEPTH_TOLERANCE = 0.004  # in mesh units; rounding and facets put points behind the depth buffer


@dataclass(frozen=True)
class EdgeMarks:
    """Points where lines cross edges of a mesh.

    Args:
        edges: (N,) edge indices without duplicates.
        fraction: (N,) positions along the edges, from 0 at the first vertex to 1 at the second.
    """

    edges: Indices
    fraction: Doubles

    def take(self, surface: MeshSurface, values: Doubles) -> Doubles:
        """Interpolate values (V, …) at the vertices to the marks, (N, …)."""
        one, other = values[surface.edges[self.edges].T]
        fraction = self.fraction.reshape(-1, *(1,) * (values.ndim - 1))
        between: Doubles = one + fraction * (other - one)
        return between

    def only(self, kept: BoolMask) -> "EdgeMarks":
        """Return the marks for which ``kept`` (N,) is true."""
        return EdgeMarks(self.edges[kept], self.fraction[kept])


def zero_marks(surface: MeshSurface, field: Doubles, usable: BoolMask) -> EdgeMarks:
    """Return the sign changes of ``field`` (V,) along edges with both ends ``usable`` (V,)."""
    one, other = field[surface.edges.T]
    crossed = np.flatnonzero(((one < 0) != (other < 0)) & usable[surface.edges].all(axis=1))
    one, other = one[crossed], other[crossed]
    return EdgeMarks(crossed, one / (one - other))


def _seen(view: View, buffers: Buffers, points: Doubles) -> tuple[Doubles, BoolMask]:
    """Return the positions (N, 2) of points (N, 3) in the sketch, and which of them are visible.

    A point is visible if one of the nine pixels around it has the same depth, because on a contour, half
    of these pixels show another surface.
    """
    place, depth = project(view.camera, points, view.size)
    visible = np.where(buffers.maps.mask, buffers.maps.depth, np.float32(np.inf))
    deepest = cv2.dilate(visible, np.ones((3, 3), np.uint8))
    column, row = np.floor(place * buffers.scale - buffers.corner).astype(np.int64).T
    height, width = deepest.shape
    deep = deepest[row.clip(0, height - 1), column.clip(0, width - 1)]
    return place, depth <= deep + _DEPTH_TOLERANCE


def _paths(surface: MeshSurface, marks: EdgeMarks, place: Doubles) -> list[Indices]:
    """Return the indices of the marks along each line, in order; marks on the same face are connected.

    ``place`` holds the positions (N, 2) of the marks in the picture.
    """
    number = np.full(len(surface.edges), -1)
    number[marks.edges] = np.arange(len(marks.edges))
    corner = number[surface.sides]
    here = corner[(corner >= 0).sum(axis=1) == 2]
    links = np.sort(here, axis=1)[:, 1:]
    return chain(place, np.unique(links, axis=0)) if len(links) else []


_FINE_SPACING = 0.25  # spacing while smoothing, in units of `SPACING`
_WEAKEST_WIDTH = 0.4  # relative width of a stroke where it is weakest


@dataclass(frozen=True)
class SurfaceDrawing(OutlinedDrawing):
    """Base class of styles that find inner lines on the mesh and draw them as long, fading strokes.

    Args:
        smoothing: standard deviation of the Gaussian applied to the curvature, as a fraction of the
            object's radius.
        strength: minimum strength of a stroke at its strongest point. A stroke continues as long as it
            reaches a third of this.
        bridge: maximum length of a gap that does not break a stroke, as a fraction of the frame's side.
    """

    smoothing: NonNegative = 0.015
    strength: Positive = 1.0
    bridge: NonNegative = 0.02

    _rounding: ClassVar[float] = 0.006
    """Standard deviation for smoothing strokes, which are jagged on a mesh, as a fraction of the side."""

    @abstractmethod
    def _find(self, shape: SurfaceShape, eye: Doubles) -> list[tuple[EdgeMarks, Doubles]]:
        """Return the points where lines cross edges of the mesh, and the lines' strengths there, (N,).

        Args:
            shape: mesh with its curvature.
            eye: (V, 3) unit vectors to the viewer.
        """

    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the strokes along the lines; see `OutlinedDrawing._draw_inside`."""
        shape = shape_of(view.mesh, self.smoothing)
        eye = towards_eye(view.camera, shape.surface.vertices)
        return [
            stroke
            for marks, strength in self._find(shape, eye)
            for stroke in self._along(shape.surface, marks, strength, view, buffers, distance)
        ]

    def _along(
        self,
        surface: MeshSurface,
        marks: EdgeMarks,
        strength: Doubles,
        view: View,
        buffers: Buffers,
        distance: Floats,
    ) -> list[Stroke]:
        """Return the strokes along marks; points outside the buffers count as hidden."""
        place, visible = _seen(view, buffers, marks.take(surface, surface.vertices))
        kept = visible & (strength > 0)
        marks, place, strength = marks.only(kept), place[kept], strength[kept]
        column, row = np.floor(place * buffers.scale - buffers.corner).astype(np.int64).T
        height, width = distance.shape
        away = distance[row.clip(0, height - 1), column.clip(0, width - 1)] / buffers.side
        strokes = []
        for path in _paths(surface, marks, place):
            points, strong = place[path] / view.size, strength[path]
            for part in _worthy_runs(
                points, strong, self.strength / 3, self.strength, self.bridge, self.shortest
            ):
                if away[path][part].mean() > self.apart:
                    strokes.append(self._stroke(points[part] * view.size, strong[part], view.size))
        return strokes

    def _stroke(self, points: Doubles, strength: Doubles, size: int) -> Stroke:
        along = lengths_along(points)
        fine = resample(points, _FINE_SPACING)
        path = resample(smooth(fine, self._rounding * size / _FINE_SPACING), SPACING)
        fraction = np.clip(strength / self.strength, 0, 1)
        here = np.interp(np.linspace(0, along[-1], len(path)), along, fraction)
        pressure = smooth(np.stack([here, here], axis=1), 3.0)[:, 0]
        width = self.interior_width * (_WEAKEST_WIDTH + (1 - _WEAKEST_WIDTH) * np.clip(pressure, 0, 1))
        return Stroke(path, width, np.ones(len(path)))


def _worthy_runs(
    points: Doubles, strength: Doubles, least: float, seed: float, bridge: float, shortest: float
) -> list[slice]:
    """Return the sections of a path (P, 2) to draw, with at least two points each.

    A section has a strength (P,) of at least ``least``, except in gaps of length up to ``bridge``. It
    reaches ``seed`` somewhere, and its length is at least ``shortest``. Lengths are in units of the
    points.

    >>> points = np.stack([np.arange(8.0), np.zeros(8)], axis=1)
    >>> strength = np.array([0, 2, 2, 0, 3, 2, 0, 2.0])
    >>> _worthy_runs(points, strength, least=1, seed=3, bridge=2, shortest=2)
    [slice(1, 8, None)]
    >>> _worthy_runs(points, strength, least=1, seed=3, bridge=1, shortest=1)
    [slice(4, 6, None)]
    """
    along = lengths_along(points)
    good = np.flatnonzero(strength >= least)
    if not len(good):
        return []
    breaks = np.flatnonzero((np.diff(good) > 1) & (np.diff(along[good]) > bridge))
    starts = good[np.concatenate([[0], breaks + 1])]
    stops = good[np.concatenate([breaks, [len(good) - 1]])]
    return [
        slice(int(start), int(stop) + 1)
        for start, stop in zip(starts, stops, strict=True)
        if stop > start
        and strength[start : stop + 1].max() >= seed
        and along[stop] - along[start] >= shortest
    ]
