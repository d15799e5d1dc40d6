"""Crossings: where a line passes between neighbouring pixels, and how crossings link up."""

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.graphs import connected
from normalgan.rendering.strokes.chain import chain

__all__ = ["PAIRS", "Crossed", "Crossings", "Line", "crossings", "places"]

_Pair = tuple[tuple[slice, slice], tuple[slice, slice]]

PAIRS: tuple[_Pair, _Pair] = (
    ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
    ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
)
"""Each pixel and its right neighbour, each pixel and the one below it."""


Crossed = tuple[Indices, Indices, Doubles, Floats, BoolMask]
"""Marked pairs along one axis: row and column of the first pixel; how far from its centre to the second's,
from 0 to 1, the line passes; how strong it is; whether it belongs to the second pixel."""


@dataclass(frozen=True)
class Line:
    """A line through the grid of pixels.

    Args:
        points: (P, 2) x to the right and y downwards in pixels, in order; a closed line ends on its first.
        pixels: (Q, 2) row and column of the pixels it belongs to.
    """

    points: Doubles
    pixels: Indices


@dataclass(frozen=True)
class Crossings:
    """Places where lines pass between two neighbouring pixels.

    Four pixel centres make a cell. A line crosses the sides of cells, each the way from a pixel's centre to
    its right or lower neighbour's; crossings of one cell belong together. That is marching squares, for any
    marked pairs of pixels instead of the level sets of a field.

    Args:
        points: (N, 2) x to the right and y downwards in pixels, pixel centres at halves.
        cells: (N, 2) numbers of the two cells on either side.
        strength: (N,) how strong the line is there.
        pixels: (N, 2) row and column of the pixel, of the two, that the line belongs to.
    """

    points: Doubles
    cells: Indices
    strength: Floats
    pixels: Indices

    def lines(self, seed: float, shortest: float) -> list[Line]:
        """Return the lines that the crossings make, the longest first.

        Args:
            seed: the strength that a line must exceed somewhere.
            shortest: least extent of a line, in pixels: the longer side of its bounding box.
        """
        solid = self._without_spurs()
        points, links = solid._links()
        # An extra point without strength joins three lines that meet.
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
        """Return the crossings without spurs of a single crossing."""
        _, cell, count = np.unique(self.cells, return_inverse=True, return_counts=True)
        around = np.sort(count[cell.reshape(-1, 2)], axis=1)
        kept = ~((around[:, 0] == 1) & (around[:, 1] > 2))
        return replace(self, **{field.name: getattr(self, field.name)[kept] for field in fields(self)})

    def _links(self) -> tuple[Doubles, Indices]:
        """Return all points, with junctions of three or four lines added (M, 2), and their links (L, 2)."""
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
    """Return which connected groups of points (N,) are strong and long enough for a line."""
    count = int(group.max()) + 1 if len(group) else 0
    strongest, low, high = np.full(count, -np.inf), np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.maximum.at(strongest, group, strength)
    np.minimum.at(low, group, points)
    np.maximum.at(high, group, points)
    kept: BoolMask = (strongest > seed) & ((high - low).max(axis=1) >= shortest)
    return kept


def places(marked: BoolMask) -> tuple[Indices, Indices]:
    """Return rows and columns of the marked pixels (H, W), as `numpy.nonzero` does, but faster for few."""
    rows, columns = np.divmod(np.flatnonzero(marked), marked.shape[1])
    return rows, columns


def crossings(pairs: tuple[Crossed, Crossed], width: int) -> Crossings:
    """Return the crossings of marked pairs of pixels.

    Args:
        pairs: across the right borders of pixels, and across their lower borders.
        width: width of the picture in pixels.
    """
    parts = []
    for axis, (row, column, share, strength, second) in enumerate(pairs):
        down, right = (share, 0.0) if axis else (0.0, share)
        # The cell with the upper left pixel (r, c) has the number (r + 1) (W + 1) + c + 1.
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
