"""Surface: the equations between the heights of neighbouring pixels, solved by reweighted least squares."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from normalgan.inference.heights.multigrid import Relaxation, Solver
from normalgan.inference.network.tile import Tile, repeats

__all__ = ["Links", "Surface", "breaks", "link"]

_STEEPEST = 0.05
"""Least nz that is believed (a slope of 20): at a contour the slope itself is infinite."""
_SURE = 12.0
"""Largest argument of the logistic: no neighbour loses its pull altogether, so that nothing floats freely."""
_GROUND = 1e-9
"""Pull of every height towards zero; without it the level of an object is undetermined."""

_RESIDUE = 1e-3
"""What each round leaves of the equations: the next one begins there, with other weights."""

_BESIDE = 2
"""Pixels on either side of a link between which the change of its normals is measured."""
_CHANGE, _NEARLY = 0.35, 0.97
"""Least change at a contour, as a chord (20°), and the share of the largest one near it that is as good."""

_Vector = NDArray[np.float64]
_Index = NDArray[np.intp]


@dataclass(frozen=True)
class Links:
    """Pairs of neighbouring pixels, each from its left or lower one to its right or upper one.

    Args:
        tail: number of the pixel that a link starts at.
        head: number of the link where it ends.
        axis: 0 along x, 1 along y.
        before: number of the link that ends where this one starts; its own number if there is none.
        after: number of the link that starts where this one ends; its own number if there is none.
    """

    tail: _Index
    head: _Index
    axis: _Index
    before: _Index
    after: _Index


def link(mask: NDArray[np.bool_], tile: Tile | None = None) -> Links:
    """Return the links of the pixels of a mask (H, W), numbered row by row; row 0 is the top.

    Where the mask is repeated, pixels at its edge are linked to those at the opposite one.

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
    """Return 1 for each link at which a surface may break, 0 for the others, (links,) in the order of `link`.

    A surface breaks at an occluding contour, where its normals change within a few pixels. Along each row and
    column these are the links with the largest change. Elsewhere a jump would be a tear.

    Args:
        normals: (H, W, 3), zero off the mask.
        mask: (H, W).
        tile: the ways in which it is repeated.
    """
    down, across = repeats(tile)
    found = []
    for axis, way, goes_on in ((1, 1, across), (0, -1, down)):
        # As `link` has them: to the right, and upwards.
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
    """The surface of one normal map.

    Args:
        normals: (H, W, 3), zero off the mask.
        mask: (H, W).
        tile: the ways in which it is repeated.
    """

    def __init__(self, normals: _Vector, mask: NDArray[np.bool_], tile: Tile | None = None) -> None:
        self.links = link(mask, tile)
        self.breaks = breaks(normals, mask, tile)
        normals = normals[mask]
        self.count = len(normals)
        steep = np.clip(normals[:, 2], _STEEPEST, 1)
        length = np.hypot(normals[:, 0], normals[:, 1])
        # What was clamped stays of unit length: else a normal that faces away would have too much slope.
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
        solver: Solver | Relaxation | None = None,
    ) -> _Vector:
        """Return the heights (n,).

        Args:
            jumps: as `normalgan.inference.heights.height.integrate` has it.
            rounds: weights and heights are found at most this often.
            tolerance: and until the energy changes by less than this share of it.
            start: (n,) heights to begin with, which also tell where the surface breaks.
            solver: solver of the equations of each round; None is multigrid.
        """
        height = np.zeros(self.count) if start is None else start
        even = np.full(len(self.links.tail), 0.5)
        weights = (even, even) if start is None or not jumps else self._weights(self._errors(height), jumps)
        last, solver = np.inf, solver or Solver(_RESIDUE)
        for _ in range(rounds if jumps else 1):
            height = solver.solve(*self._system(*weights), height)
            errors = self._errors(height)
            energy = float((weights[0] * errors[0] ** 2 + weights[1] * errors[1] ** 2).sum())
            if last - energy <= tolerance * last < np.inf:
                break
            last = energy
            weights = self._weights(errors, jumps)
        return height

    def _weights(self, errors: tuple[_Vector, _Vector], jumps: float) -> tuple[_Vector, _Vector]:
        """Return how much each link counts for the normals at its two ends, (links,) each."""
        # Towards an occluding contour the nearer surface turns away, so it drops where the normals lean.
        # Else a bowl's walls drift apart at the ends of its front rim, the inner one to the front.
        rises = self.steep[0] * errors[0] + self.steep[1] * errors[1]
        ready = jumps * self.breaks * (rises * (self.tilt[0] + self.tilt[1]) <= 0)
        squared = errors[0] ** 2, errors[1] ** 2
        # What the same normal says of the other side of its pixel.
        before, after = self.links.before, self.links.after
        own = np.arange(len(before))
        across = (
            np.where(before == own, squared[0], squared[1][before]),
            np.where(after == own, squared[1], squared[0][after]),
        )
        return _logistic(ready * (across[0] - squared[0])), _logistic(ready * (across[1] - squared[1]))

    def _errors(self, height: _Vector) -> tuple[_Vector, _Vector]:
        """Return each link's deviation from the slopes that the normals at its ends say, (links,)."""
        rise = height[self.links.head] - height[self.links.tail]
        return self.steep[0] * rise + self.tilt[0], self.steep[1] * rise + self.tilt[1]

    def _system(self, *weights: _Vector) -> tuple[sparse.csr_array, _Vector]:
        """Return the normal equations: the Laplacian of the weighted links, and the right-hand side."""
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
