"""Lines on a mesh: visible crossings of its edges, chained to paths in the picture."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Indices
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.projection import project
from normalgan.rendering.lines.surface import Surface
from normalgan.rendering.strokes.chain import chain
from normalgan.rendering.view import View

__all__ = ["EdgeMarks", "paths", "seen", "zero_marks"]

_DEEPER = 0.004  # in units of the mesh; rounding and facets put points behind the depth buffer


@dataclass(frozen=True)
class EdgeMarks:
    """Places where a line crosses edges of a mesh.

    Args:
        edges: (N,) which edges, no edge twice.
        share: (N,) how far along, from 0 at the edge's first vertex to 1.
    """

    edges: Indices
    share: Doubles

    def take(self, surface: Surface, values: Doubles) -> Doubles:
        """Return values (V, …) at the vertices, interpolated (N, …)."""
        one, other = values[surface.edges[self.edges].T]
        share = self.share.reshape(-1, *(1,) * (values.ndim - 1))
        between: Doubles = one + share * (other - one)
        return between

    def only(self, kept: BoolMask) -> "EdgeMarks":
        """Return the lines for which ``kept`` (N,) is true."""
        return EdgeMarks(self.edges[kept], self.share[kept])


def zero_marks(surface: Surface, field: Doubles, usable: BoolMask) -> EdgeMarks:
    """Return where ``field`` (V,) changes sign along an edge with both ends ``usable`` (V,)."""
    one, other = field[surface.edges.T]
    crossed = np.flatnonzero(((one < 0) != (other < 0)) & usable[surface.edges].all(axis=1))
    one, other = one[crossed], other[crossed]
    return EdgeMarks(crossed, one / (one - other))


def seen(view: View, buffers: Buffers, points: Doubles) -> tuple[Doubles, BoolMask]:
    """Return the positions of points (N, 3) in the sketch, (N, 2), and which are visible.

    A point counts as visible if one of the nine pixels around it has the same depth: on a
    contour half of them show the surface behind or in front.
    """
    place, depth = project(view.camera, points, view.size)
    visible = np.where(buffers.maps.mask, buffers.maps.depth, np.float32(np.inf))
    deepest = cv2.dilate(visible, np.ones((3, 3), np.uint8))
    column, row = np.floor(place * buffers.scale - buffers.corner).astype(np.int64).T
    height, width = deepest.shape
    deep = deepest[row.clip(0, height - 1), column.clip(0, width - 1)]
    return place, depth <= deep + _DEEPER


def paths(surface: Surface, marks: EdgeMarks, place: Doubles) -> list[Indices]:
    """Return the marks along each line, in order; two on sides of one face belong together.

    Args:
        surface: the mesh.
        marks: N places on its edges.
        place: (N, 2) where they lie in the picture.
    """
    number = np.full(len(surface.edges), -1)
    number[marks.edges] = np.arange(len(marks.edges))
    corner = number[surface.sides]
    here = corner[(corner >= 0).sum(axis=1) == 2]
    links = np.sort(here, axis=1)[:, 1:]
    return chain(place, np.unique(links, axis=0)) if len(links) else []
