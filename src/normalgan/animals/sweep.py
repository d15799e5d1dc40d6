"""Sweeps: an ellipse of changing size moved along a curve, the one primitive of which animals are made."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cut", "Floats", "Sweep", "Volume", "area", "reach", "segment_distance", "smoothed", "way_along"]

Floats = NDArray[np.float64]
Volume = NDArray[np.float32]


class Cut(NamedTuple):
    """A plane beyond which there is nothing.

    Args:
        point: (3,) on it.
        normal: (3,) outwards, of unit length.
    """

    point: Floats
    normal: Floats


@dataclass(frozen=True, eq=False)
class Sweep:
    """A tube with elliptical sections and rounded ends.

    Args:
        points: (n, 3) the curve, n ≥ 2.
        radii: (n,) radius of the section across ``sides``.
        widths: (n,) radius of the section along ``sides``.
        sides: (n, 3) direction of the second axis of each section; its part along the curve is ignored.
        cut: a plane beyond which the last third ends flat (soles, snouts); it may well run through the rest,
            as that of a folded leg does.
    """

    points: Floats
    radii: Floats
    widths: Floats
    sides: Floats
    cut: Cut | None = None


def smoothed(sweep: Sweep, pieces: int = 4, thinnest: float = 0.0) -> Sweep:
    """Return the sweep with ``pieces`` segments per span along a smooth curve, no radius below ``thinnest``.

    Akima's interpolation goes through the stations and hardly overshoots beside steep steps.
    """
    from scipy.interpolate import Akima1DInterpolator  # as slow to import as all that is here

    rows = np.column_stack([sweep.points, sweep.radii, sweep.widths, sweep.sides])
    count = len(rows)
    if count > 2:
        knots = np.arange(count, dtype=float)
        rows = Akima1DInterpolator(knots, rows)(np.linspace(0, count - 1, (count - 1) * pieces + 1))
    radii, widths = np.maximum(rows[:, 3], thinnest), np.maximum(rows[:, 4], thinnest)
    return Sweep(rows[:, :3], radii, widths, rows[:, 5:], sweep.cut)


def reach(sweep: Sweep) -> tuple[Floats, Floats]:
    """Return the lowest and highest corner, (3,) each, of a box that holds the sweep."""
    fat = np.maximum(sweep.radii, sweep.widths)[:, None]
    return (sweep.points - fat).min(axis=0), (sweep.points + fat).max(axis=0)


def way_along(points: Floats) -> Floats:
    """Return how far each of (n, 3) points is along the line through them, (n,), from 0.

    >>> way_along(np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 1.0]])).tolist()
    [0.0, 5.0, 6.0]
    """
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def area(sweep: Sweep) -> float:
    """Return about how much surface the sweep has, its ends left out."""
    lengths = np.linalg.norm(np.diff(sweep.points, axis=0), axis=1)
    mean = np.sqrt((sweep.radii**2 + sweep.widths**2) / 2)
    return float(np.sum(np.pi * (mean[1:] + mean[:-1]) * lengths))


def segment_distance(sweep: Sweep, index: int, x: Volume, y: Volume, z: Volume) -> Volume:
    """Return the approximate signed distance to segment ``index`` on an open grid, negative inside.

    The section is scaled to a circle along its side axis; dividing the scaled distance by the length of
    its gradient makes it true to first order near the surface (Quilez, "Ellipsoid SDF", 2008).

    Args:
        sweep: the tube.
        index: the segment from station ``index`` to the next.
        x: (nx, 1, 1) grid coordinates.
        y: (1, ny, 1) grid coordinates.
        z: (1, 1, nz) grid coordinates.

    Returns:
        (nx, ny, nz)
    """
    start = sweep.points[index]
    along = sweep.points[index + 1] - start
    square = max(float(along @ along), 1e-12)
    side = sweep.sides[index] + sweep.sides[index + 1]
    side = side - (side @ along) / square * along
    side = (side / max(float(np.linalg.norm(side)), 1e-9)).astype(np.float32)
    ax, ay, az = along.astype(np.float32)
    px, py, pz = x - np.float32(start[0]), y - np.float32(start[1]), z - np.float32(start[2])
    t = np.clip((px * ax + py * ay + pz * az) / np.float32(square), 0, 1)
    dx, dy, dz = px - t * ax, py - t * ay, pz - t * az
    across = dx * side[0] + dy * side[1] + dz * side[2]
    across *= across
    length = dx * dx + dy * dy + dz * dz
    r0, r1 = sweep.radii[index], sweep.radii[index + 1]
    m0, m1 = sweep.widths[index] / r0, sweep.widths[index + 1] / r1
    ratio = np.float32(m0) + t * np.float32(m1 - m0)
    ratio = 1 / (ratio * ratio)
    scaled = length + across * (ratio - 1)
    slope = np.sqrt(length + across * (ratio * ratio - 1) + np.float32(1e-12))
    reached = np.sqrt(scaled + np.float32(1e-12))
    radius = np.float32(r0) + t * np.float32(r1 - r0)
    distance: Volume = (reached - radius) * reached / slope
    return distance
