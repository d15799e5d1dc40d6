"""Surface: solve for the heights of a normal map by iteratively reweighted least squares."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from normalgan.inference.heights.multigrid import Solver
from normalgan.inference.network.tile import Tile, repeats

_STEEPEST = 0.05
"""Minimum nz, a slope of 20; at a contour the true slope is infinite."""
_SURE = 12.0
"""Maximum argument of the logistic function; with a weight of 0, part of the surface could float freely."""
_GROUND = 1e-9
"""Weight of a pull of every height towards zero, without which the level of an object is undetermined."""

_RESIDUE = 1e-3
"""Relative residual at which a round stops; the next round continues from there with new weights."""

_BESIDE = 2
"""Number of pixels on either side of a link across which the change of the normals is measured."""
_CHANGE, _NEARLY = 0.35, 0.97
"""Minimum change at a contour, as a chord (20°), and as a fraction of the largest change nearby."""

_Vector = NDArray[np.float64]
_Index = NDArray[np.intp]


@dataclass(frozen=True)
class Links:
    """Links between neighbouring pixels, directed to the right and up.

    Args:
        tail: (links,), index of the pixel at the start of each link.
        head: (links,), index of the pixel at its end.
        axis: (links,), 0 along x, 1 along y.
        before: (links,), index of the previous link along the axis; the link's own index if there is none.
        after: (links,), index of the next link along the axis; the link's own index if there is none.
    """

    tail: _Index
    head: _Index
    axis: _Index
    before: _Index
    after: _Index


def link(mask: NDArray[np.bool_], tile: Tile | None = None) -> Links:
    """Return the links between the pixels of a mask (H, W), which are numbered row by row from the top.

    Where the mask repeats, pixels at opposite edges are linked.

    >>> links = link(np.array([[True, True], [True, False]]))
    >>> links.tail.tolist(), links.head.tolist(), links.axis.tolist()
    ([0, 2], [1, 0], [0, 1])
    """
    number = np.full(mask.shape, -1)
    number[mask] = np.arange(np.count_nonzero(mask))
    beside, above = np.roll(number, -1, 1), np.roll(number, 1, 0)
    down, across = repeats(tile)
    beside[:, -1] = beside[:, -1] if across else -1
    above[0] = above[0] if down else -1
    right, up = mask & (beside >= 0), mask & (above >= 0)
    tail = np.concatenate([number[right], number[up]])
    head = np.concatenate([beside[right], above[up]])
    axis = np.repeat([0, 1], [np.count_nonzero(right), np.count_nonzero(up)])
    own = np.arange(len(tail))
    ending, starting = np.full((2, np.count_nonzero(mask), 2), -1)
    ending[head, axis], starting[tail, axis] = own, own
    before, after = ending[tail, axis], starting[head, axis]
    return Links(tail, head, axis, np.where(before < 0, own, before), np.where(after < 0, own, after))


def breaks(normals: _Vector, mask: NDArray[np.bool_], tile: Tile | None = None) -> _Vector:
    """Return (links,) 1 for links at which the surface may break and 0 for others, in the order of `link`.

    A surface breaks at an occluding contour, where its normals change within a few pixels. These are the
    links with the locally largest change along a row or column. Elsewhere a jump would be a tear.

    Args:
        normals: (H, W, 3), zero off the mask.
        mask: (H, W), the object.
        tile: directions in which the mask repeats.
    """
    down, across = repeats(tile)
    found = []
    for axis, way, goes_on in ((1, 1, across), (0, -1, down)):
        # In the directions of `link`: to the right and up.
        def at(values: NDArray[Any], step: int, axis: int = axis, way: int = way) -> NDArray[Any]:
            return np.roll(values, -way * step, axis)

        change = np.linalg.norm(at(normals, 1 + _BESIDE) - at(normals, -_BESIDE), axis=-1)
        known = at(mask, 1 + _BESIDE) & at(mask, -_BESIDE)
        if not goes_on:
            places = np.arange(mask.shape[axis]) * way
            first, last = places.min(), places.max()
            held = (places - _BESIDE >= first) & (places + 1 + _BESIDE <= last)
            known = known & (held[None] if axis else held[:, None])
        change = np.where(known, change, 0)
        most = np.max([at(change, step) for step in range(-_BESIDE, _BESIDE + 1)], 0)
        there = (change > _CHANGE) & (change >= _NEARLY * most)
        linked = mask & at(mask, 1)
        if not goes_on:
            ends = np.arange(mask.shape[axis]) == (mask.shape[axis] - 1 if way > 0 else 0)
            linked = linked & ~(ends[None] if axis else ends[:, None])
        found.append(there[linked])
    return np.concatenate(found).astype(np.float64)


class Surface:
    """The system of equations for the heights of one normal map.

    Args:
        normals: (H, W, 3), zero off the mask.
        mask: (H, W), the object.
        tile: directions in which the map repeats.
    """

    def __init__(self, normals: _Vector, mask: NDArray[np.bool_], tile: Tile | None = None) -> None:
        self.links = link(mask, tile)
        self.breaks = breaks(normals, mask, tile)
        normals = normals[mask]
        self.count = len(normals)
        steep = np.clip(normals[:, 2], _STEEPEST, 1)
        length = np.hypot(normals[:, 0], normals[:, 1])
        # Clamped normals keep unit length; otherwise a normal that faces away would be too steep.
        fit = np.minimum(1, np.sqrt(1 - steep**2) / np.maximum(length, 1e-9))
        tilt = normals[:, :2] * fit[:, None]
        ends = self.links.tail, self.links.head
        self.steep = steep[ends[0]], steep[ends[1]]
        self.tilt = tilt[ends[0], self.links.axis], tilt[ends[1], self.links.axis]

    def solve(
        self,
        jumps: float,
        rounds: int,
        tolerance: float,
        start: _Vector | None = None,
        solve: Callable[[sparse.csr_array, _Vector, _Vector], _Vector] | None = None,
    ) -> _Vector:
        """Return the heights (n,) of the pixels on the mask.

        Args:
            jumps: as in `normalgan.inference.heights.height.integrate`.
            rounds: maximum number of reweighting rounds.
            tolerance: relative change of the energy that ends the rounds.
            start: (n,), initial heights, which also give the initial weights; None starts from zero.
            solve: solves the equations of each round from a guess; None uses multigrid.
        """
        height = np.zeros(self.count) if start is None else start
        even = np.full(len(self.links.tail), 0.5)
        weights = (even, even) if start is None or not jumps else self._weights(self._errors(height), jumps)
        last, solve = np.inf, solve or Solver(_RESIDUE).solve
        for _ in range(rounds if jumps else 1):
            height = solve(*self._system(*weights), height)
            errors = self._errors(height)
            energy = float((weights[0] * errors[0] ** 2 + weights[1] * errors[1] ** 2).sum())
            if last - energy <= tolerance * last < np.inf:
                break
            last = energy
            weights = self._weights(errors, jumps)
        return height

    def _weights(self, errors: tuple[_Vector, _Vector], jumps: float) -> tuple[_Vector, _Vector]:
        """Return the weights of each link for the normals at its two ends, (links,) each."""
        # The nearer surface at an occluding contour turns away, so a break may only drop in the direction in
        # which the normals lean. Otherwise the walls of a bowl drift apart at the ends of its front rim.
        rises = self.steep[0] * errors[0] + self.steep[1] * errors[1]
        ready = jumps * self.breaks * (rises * (self.tilt[0] + self.tilt[1]) <= 0)
        squared = errors[0] ** 2, errors[1] ** 2
        # Errors of the same normals on the other side of their pixels.
        before, after = self.links.before, self.links.after
        own = np.arange(len(before))
        across = (
            np.where(before == own, squared[0], squared[1][before]),
            np.where(after == own, squared[1], squared[0][after]),
        )
        return _logistic(ready * (across[0] - squared[0])), _logistic(ready * (across[1] - squared[1]))

    def _errors(self, height: _Vector) -> tuple[_Vector, _Vector]:
        """Return the deviation of each link from the slopes of the normals at its two ends, (links,) each."""
        rise = height[self.links.head] - height[self.links.tail]
        return self.steep[0] * rise + self.tilt[0], self.steep[1] * rise + self.tilt[1]

    def _system(self, *weights: _Vector) -> tuple[sparse.csr_array, _Vector]:
        """Return the normal equations: the weighted graph Laplacian of the links and the right-hand side."""
        tail, head = self.links.tail, self.links.head
        stiff = weights[0] * self.steep[0] ** 2 + weights[1] * self.steep[1] ** 2
        pull = -weights[0] * self.steep[0] * self.tilt[0] - weights[1] * self.steep[1] * self.tilt[1]
        every = np.arange(self.count)
        values = np.concatenate([stiff, stiff, -stiff, -stiff, np.full(self.count, _GROUND)])
        rows = np.concatenate([tail, head, tail, head, every])
        columns = np.concatenate([tail, head, head, tail, every])
        matrix = sparse.csr_array((values, (rows, columns)), shape=(self.count, self.count))
        forces = np.bincount(head, pull, self.count) - np.bincount(tail, pull, self.count)
        return matrix, forces.astype(np.float64)


def _logistic(x: _Vector) -> _Vector:
    return 1 / (1 + np.exp(-np.clip(x, -_SURE, _SURE)))
