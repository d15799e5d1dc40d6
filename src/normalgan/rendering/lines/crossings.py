"""Crossings: points where lines pass between neighbouring pixels, and their connection to lines."""

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.graphs import connected
from normalgan.rendering.strokes.chain import chain

_Pair = tuple[tuple[slice, slice], tuple[slice, slice]]

PAIRS: tuple[_Pair, _Pair] = (
    ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
    ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
)
"""Pairs of each pixel and its right neighbour, then of each pixel and its lower neighbour."""


Crossed = tuple[Indices, Indices, Doubles, Floats, BoolMask]
"""Marked pairs along one axis: row and column of the first pixel, position of the line between the two
centres from 0 to 1, its strength, and whether it belongs to the second pixel."""


@dataclass(frozen=True)
class Line:
    """A line through the pixel grid.

    Args:
        points: (P, 2) points in order, x right and y down in pixels; a closed line ends with its first
            point.
        pixels: (Q, 2) row and column of the pixels that the line belongs to.
    """

    points: Doubles
    pixels: Indices


@dataclass(frozen=True)
class Crossings:
    """Points where lines pass between two neighbouring pixels.

    Four pixel centres form a cell. Lines cross the sides of cells, which connect the centre of a pixel to
    those of its right and lower neighbours. Crossings of the same cell are connected. This is marching
    squares for arbitrary marked pairs of pixels instead of level sets.

    Args:
        points: (N, 2) x right and y down in pixels, with pixel centres at halves.
        cells: (N, 2) indices of the two adjacent cells.
        strength: (N,) strength of the line at each crossing.
        pixels: (N, 2) row and column of the pixel that the line belongs to.
    """

    points: Doubles
    cells: Indices
    strength: Floats
    pixels: Indices

    def lines(self, seed: float, shortest: float) -> list[Line]:
        """Return the lines through the crossings, longest first.

        Args:
            seed: strength that a line must exceed somewhere.
            shortest: minimum longer side of a line's bounding box, in pixels.
        """
        solid = self._without_spurs()
        points, links = solid._links()
        # An extra point without strength joins the lines at a junction.
        strength = np.append(solid.strength, np.full(len(points) - len(solid.points), -np.inf))
        group = connected(len(points), links)
        links = links[_groups(points, strength, group, seed, shortest)[group[links[:, 0]]]]
        found = []
        for path in chain(points, links):
            place = points[path]
            if np.ptp(place, axis=0).max() >= shortest:
                found.append(Line(place, solid.pixels[path[path < len(solid.points)]]))
        return sorted(found, key=lambda line: -len(line.points))

    def _without_spurs(self) -> Self:
        """Return the crossings without spurs that consist of a single crossing."""
        _, cell, count = np.unique(self.cells, return_inverse=True, return_counts=True)
        around = np.sort(count[cell.reshape(-1, 2)], axis=1)
        kept = ~((around[:, 0] == 1) & (around[:, 1] > 2))
        return replace(self, **{field.name: getattr(self, field.name)[kept] for field in fields(self)})

    def _links(self) -> tuple[Doubles, Indices]:
        """Return all points (M, 2), including junctions of three or four lines, and their links (L, 2)."""
        cells = self.cells.ravel()
        order = np.argsort(cells, kind="stable")
        _, start, count = np.unique(cells[order], return_index=True, return_counts=True)
        owner = order // 2
        two = start[count == 2]
        links = [np.stack([owner[two], owner[two + 1]], axis=1)]
        points = [self.points]
        extra = len(self.points)
        for many in (3, 4):
            members = owner[start[count == many][:, None] + np.arange(many)]
            hub = np.repeat(np.arange(extra, extra + len(members)), many)
            points.append(self.points[members].mean(axis=1))
            links.append(np.stack([members.ravel(), hub], axis=1))
            extra += len(members)
        return np.concatenate(points), np.concatenate(links)


def _groups(points: Doubles, strength: Floats, group: Indices, seed: float, shortest: float) -> BoolMask:
    """Return which connected groups of the points (N,) are strong and long enough to be lines."""
    count = int(group.max()) + 1 if len(group) else 0
    strongest, low, high = np.full(count, -np.inf), np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.maximum.at(strongest, group, strength)
    np.minimum.at(low, group, points)
    np.maximum.at(high, group, points)
    kept: BoolMask = (strongest > seed) & ((high - low).max(axis=1) >= shortest)
    return kept


def places(marked: BoolMask) -> tuple[Indices, Indices]:
    """Return rows and columns of marked pixels (H, W), like `numpy.nonzero` but faster if there are few."""
    rows, columns = np.divmod(np.flatnonzero(marked), marked.shape[1])
    return rows, columns


def crossings(pairs: tuple[Crossed, Crossed], width: int) -> Crossings:
    """Return the crossings of marked pairs of pixels.

    Args:
        pairs: marked pairs across the right borders of pixels, and across their lower borders.
        width: width of the picture in pixels.
    """
    parts = []
    for axis, (row, column, fraction, strength, second) in enumerate(pairs):
        down, right = (fraction, 0.0) if axis else (0.0, fraction)
        # The cell with the upper left pixel (r, c) has the index (r + 1) (W + 1) + c + 1.
        cell = (row + 1) * (width + 1) + column + 1
        parts.append(
            (
                np.stack([column + 0.5 + right, row + 0.5 + down], axis=1),
                np.stack([cell - (1 if axis else width + 1), cell], axis=1),
                strength,
                np.stack([row + second * axis, column + second * (1 - axis)], axis=1),
            )
        )
    return Crossings(*(np.concatenate(both) for both in zip(*parts, strict=True)))
