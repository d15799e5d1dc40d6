"""Shapes of animals: sweeps along a curve, and solids where sweeps are inconvenient."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, Self

import numpy as np

from normalgan.animals.frames import Axes, Frame, Volume
from normalgan.arrays import Doubles

MIRROR = np.array([1.0, 1.0, -1.0])  # factors that mirror a point
_TINY = np.float32(1e-9)  # keeps square roots and divisions finite at the centre
_BAND = 0.15  # fraction of an outline's extent; farther away, no blend needs the distance to its edge


class Piece(NamedTuple):
    """A piece of a shape that is sampled in one box.

    Args:
        low: (3,) lowest corner of the bounding box.
        high: (3,) highest corner of the bounding box.
        distance: function for the distance of points to the shape; see `Solid.distance`.
    """

    low: Doubles
    high: Doubles
    distance: Callable[[Axes], Volume]


class Shape(ABC):
    """A closed body with an approximate distance function."""

    @abstractmethod
    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the lowest and highest corner, (3,) each, of a bounding box."""

    @abstractmethod
    def area(self) -> float:
        """Return the approximate surface area."""

    @abstractmethod
    def thickened(self, thinnest: float) -> Self:
        """Return the shape with radii of at least ``thinnest``, below which the grid would miss it."""

    @abstractmethod
    def placed(self, frame: Frame, size: float = 1.0) -> Self:
        """Return the shape scaled by ``size`` and placed in a frame."""

    @abstractmethod
    def mirrored(self) -> Self:
        """Return the mirror image in the plane z = 0."""

    @abstractmethod
    def pieces(self, spacing: float) -> Iterator[Piece]:
        """Yield the pieces of the shape for a grid with the given spacing."""


class Cut(NamedTuple):
    """A plane that cuts off everything beyond it.

    Args:
        point: (3,) point on the plane.
        normal: (3,) outward unit normal.
    """

    point: Doubles
    normal: Doubles


@dataclass(frozen=True, eq=False)
class Sweep(Shape):
    """A tube with elliptical sections and rounded ends.

    Args:
        points: (n, 3) points of the curve, n ≥ 2.
        radii: (n,) radii of the sections across ``sides``.
        widths: (n,) radii of the sections along ``sides``.
        sides: (n, 3) direction of the second axis of each section; the component along the curve is
            ignored.
        cut: plane that cuts the last third off flat (soles, snouts); None for a rounded end. In a folded
            leg, it may intersect other parts too.
    """

    points: Doubles
    radii: Doubles
    widths: Doubles
    sides: Doubles
    cut: Cut | None = None

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the corners of a bounding box."""
        fat = np.maximum(self.radii, self.widths)[:, None]
        return (self.points - fat).min(axis=0), (self.points + fat).max(axis=0)

    def area(self) -> float:
        """Return the approximate surface area without the ends."""
        lengths = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        mean = np.sqrt((self.radii**2 + self.widths**2) / 2)
        return float(np.sum(np.pi * (mean[1:] + mean[:-1]) * lengths))

    def smoothed(self, pieces: int = 4, thinnest: float = 0.0) -> Self:
        """Return a smooth sweep with ``pieces`` segments per span and radii of at least ``thinnest``.

        Akima's interpolation passes through the stations and hardly overshoots next to steep steps.
        """
        from scipy.interpolate import Akima1DInterpolator  # as slow to import as this whole module

        rows = np.column_stack([self.points, self.radii, self.widths, self.sides])
        count = len(rows)
        if count > 2:
            knots = np.arange(count, dtype=float)
            rows = Akima1DInterpolator(knots, rows)(np.linspace(0, count - 1, (count - 1) * pieces + 1))
        radii, widths = np.maximum(rows[:, 3], thinnest), np.maximum(rows[:, 4], thinnest)
        return replace(self, points=rows[:, :3], radii=radii, widths=widths, sides=rows[:, 5:])

    def thickened(self, thinnest: float) -> Self:
        """Return a smooth sweep, because kinks between the segments of thick tubes would show as rings."""
        thick = max(self.radii.max(), self.widths.max()) > 8 * thinnest
        return self.smoothed(10 if thick else 4, thinnest)

    def placed(self, frame: Frame, size: float = 1.0) -> Self:
        """Return the shape scaled by ``size`` and placed in a frame."""
        points, sides, cut = frame.place(self.points * size), self.sides @ frame.rotation.T, self.cut
        if cut is not None:
            cut = Cut(frame.place(cut.point * size), frame.rotation @ cut.normal)
        return replace(
            self, points=points, radii=self.radii * size, widths=self.widths * size, sides=sides, cut=cut
        )

    def mirrored(self) -> Self:
        """Return the mirror image in the plane z = 0."""
        cut = None if self.cut is None else Cut(self.cut.point * MIRROR, self.cut.normal * MIRROR)
        return replace(self, points=self.points * MIRROR, sides=self.sides * MIRROR, cut=cut)

    def pieces(self, spacing: float) -> Iterator[Piece]:
        """Yield the segments."""
        fat = np.maximum(self.radii, self.widths)
        for i in range(len(self.points) - 1):
            pad, ends = max(fat[i], fat[i + 1]), self.points[i : i + 2]
            distance = partial(self.distance, i)
            if self.cut is not None and 3 * i >= 2 * len(self.points):
                distance = partial(self._cut_distance, i, self.cut, 1.5 * spacing)
            yield Piece(ends.min(axis=0) - pad, ends.max(axis=0) + pad, distance)

    def distance(self, index: int, axes: Axes) -> Volume:
        """Return the approximate signed distance to the segment between two stations; see `Solid.distance`.

        The section is scaled to a circle along its side axis. Dividing the scaled distance by the length
        of its gradient makes it correct to first order near the surface (Quilez, "Ellipsoid SDF", 2008).
        """
        start = self.points[index]
        along = self.points[index + 1] - start
        square = max(float(along @ along), 1e-12)
        side = self.sides[index] + self.sides[index + 1]
        side = side - (side @ along) / square * along
        side = (side / max(float(np.linalg.norm(side)), 1e-9)).astype(np.float32)
        ax, ay, az = along.astype(np.float32)
        px, py, pz = (axis - np.float32(at) for axis, at in zip(axes, start, strict=True))
        t = np.clip((px * ax + py * ay + pz * az) / np.float32(square), 0, 1)
        dx, dy, dz = px - t * ax, py - t * ay, pz - t * az
        across = dx * side[0] + dy * side[1] + dz * side[2]
        across *= across
        length = dx * dx + dy * dy + dz * dz
        r0, r1 = self.radii[index], self.radii[index + 1]
        m0, m1 = self.widths[index] / r0, self.widths[index + 1] / r1
        ratio = np.float32(m0) + t * np.float32(m1 - m0)
        ratio = 1 / (ratio * ratio)
        scaled = length + across * (ratio - 1)
        slope = np.sqrt(length + across * (ratio * ratio - 1) + np.float32(1e-12))
        reached = np.sqrt(scaled + np.float32(1e-12))
        radius = np.float32(r0) + t * np.float32(r1 - r0)
        distance: Volume = (reached - radius) * reached / slope
        return distance

    def _cut_distance(self, index: int, cut: Cut, soft: float, axes: Axes) -> Volume:
        x, y, z = ((axis - at) * n for axis, at, n in zip(axes, cut.point, cut.normal, strict=True))
        return -smooth_minimum(-self.distance(index, axes), -(x + y + z).astype(np.float32), soft)


def smooth_minimum(a: Volume, b: Volume, width: float) -> Volume:
    """Return min(a, b), smoothed where they differ by less than ``width`` (Quilez, cubic polynomial).

    >>> float(smooth_minimum(np.float32([1]), np.float32([3]), 1.0)[0])
    1.0
    """
    if width <= 0:
        return np.minimum(a, b)
    near = np.maximum(np.float32(width) - np.abs(a - b), 0) / np.float32(width)
    return np.asarray(np.minimum(a, b) - near * near * near * np.float32(width / 6), np.float32)


@dataclass(frozen=True, eq=False)
class Solid(Shape):
    """A shape in its own coordinate frame, sampled in one box.

    Args:
        frame: centre and axes of the shape.
    """

    frame: Frame

    @abstractmethod
    def distance(self, axes: Axes) -> Volume:
        """Return the approximate signed distance (nx, ny, nz), negative inside, exact near the surface."""

    @abstractmethod
    def _scaled(self, size: float) -> Self:
        """Return the shape with its lengths, but not its frame, multiplied by ``size``."""

    def placed(self, frame: Frame, size: float = 1.0) -> Self:
        """Return the shape scaled by ``size`` and placed in a frame."""
        return replace(self._scaled(size), frame=self.frame.carried(frame, size))

    def mirrored(self) -> Self:
        """Return the mirror image in the plane z = 0."""
        # The body is symmetric in its own planes, so the reflection becomes a rotation.
        rotation = self.frame.rotation * MIRROR[:, None] * MIRROR
        return replace(self, frame=Frame(self.frame.origin * MIRROR, rotation))

    def pieces(self, spacing: float) -> Iterator[Piece]:
        """Yield the whole solid."""
        yield Piece(*self.reach(), self.distance)

    def _local(self, axes: Axes) -> Axes:
        """Return the coordinates along the axes of the body, (nx, ny, nz) each or open."""
        turn, start = self.frame.rotation.astype(np.float32), self.frame.origin.astype(np.float32)
        px, py, pz = (axis - at for axis, at in zip(axes, start, strict=True))
        if np.array_equal(turn, np.eye(3)):
            return px, py, pz
        u, v, w = (turn[0, i] * px + turn[1, i] * py + turn[2, i] * pz for i in range(3))
        return u, v, w


@dataclass(frozen=True, eq=False)
class Ellipsoid(Solid):
    """An ellipsoid.

    Args:
        radii: (3,) radii along the axes.
    """

    radii: Doubles

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the corners of a bounding box."""
        half = np.linalg.norm(self.frame.rotation * self.radii, axis=1)
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return the surface area by Thomsen's formula, within 1.1 %."""
        a, b, c = self.radii**1.6075
        return float(4 * np.pi * ((a * b + b * c + c * a) / 3) ** (1 / 1.6075))

    def distance(self, axes: Axes) -> Volume:
        """Return the signed distance to first order (Quilez, "Ellipsoid SDF", 2008)."""
        u, v, w = self._local(axes)
        a, b, c = (np.float32(1 / radius) for radius in self.radii)
        u, v, w = u * a, v * b, w * c
        level = np.sqrt(u * u + v * v + w * w + _TINY)
        u, v, w = u * a, v * b, w * c
        distance: Volume = level * (level - 1) / np.sqrt(u * u + v * v + w * w + _TINY)
        return distance

    def thickened(self, thinnest: float) -> Self:
        """Return the ellipsoid with radii of at least ``thinnest``."""
        return replace(self, radii=np.maximum(self.radii, thinnest))

    def _scaled(self, size: float) -> Self:
        return replace(self, radii=self.radii * size)


@dataclass(frozen=True, eq=False)
class Box(Solid):
    """A box with rounded edges.

    Args:
        half: (3,) half lengths along the axes, including the rounding.
        rounding: radius of the edges, at most the minimum of ``half``.
    """

    half: Doubles
    rounding: float

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the corners of a bounding box."""
        half = np.abs(self.frame.rotation) @ (self.half - self.rounding) + self.rounding
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return an upper bound of the area, that of the box with sharp edges."""
        a, b, c = self.half
        return float(8 * (a * b + b * c + c * a))

    def distance(self, axes: Axes) -> Volume:
        """Return the signed distance, which is exact outside."""
        core = (self.half - self.rounding).astype(np.float32)
        u, v, w = (np.abs(p) - h for p, h in zip(self._local(axes), core, strict=True))
        inside = np.minimum(np.maximum(np.maximum(u, v), w), 0)
        u, v, w = np.maximum(u, 0), np.maximum(v, 0), np.maximum(w, 0)
        distance: Volume = np.sqrt(u * u + v * v + w * w) + inside - np.float32(self.rounding)
        return distance

    def thickened(self, thinnest: float) -> Self:
        """Return the box with half lengths of at least ``thinnest``."""
        return replace(self, half=np.maximum(self.half, thinnest))

    def _scaled(self, size: float) -> Self:
        return replace(self, half=self.half * size, rounding=self.rounding * size)


@dataclass(frozen=True, eq=False)
class Ring(Solid):
    """A torus around its own second axis.

    Args:
        major: radius of the centre circle.
        minor: radius of the tube.
    """

    major: float
    minor: float

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the corners of a bounding box."""
        half = self.major * np.sqrt(np.maximum(1 - self.frame.rotation[:, 1] ** 2, 0)) + self.minor
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return the surface area."""
        return float(4 * np.pi**2 * self.major * self.minor)

    def distance(self, axes: Axes) -> Volume:
        """Return the exact signed distance."""
        u, v, w = self._local(axes)
        out = np.sqrt(u * u + w * w) - np.float32(self.major)
        return np.sqrt(out * out + v * v) - np.float32(self.minor)

    def thickened(self, thinnest: float) -> Self:
        """Return the torus with a tube radius of at least ``thinnest``."""
        return replace(self, minor=max(self.minor, thinnest))

    def _scaled(self, size: float) -> Self:
        return replace(self, major=self.major * size, minor=self.minor * size)


@dataclass(frozen=True, eq=False)
class Plate(Solid):
    """A closed outline in its own plane, thickened to both sides with a round rim, such as a fin or wing.

    Args:
        frame: frame of the plane; the first two axes are those of the outline, and the third is
            perpendicular.
        outline: (n, 2) corners in either orientation, n ≥ 3.
        rim: half thickness at the rim.
        swell: increase of the half thickness per distance from the rim.
        most: maximum half thickness.
        bow: curvature along the first and second axis; positive bends towards the third.
    """

    outline: Doubles
    rim: float
    swell: float = 0.0
    most: float = np.inf
    bow: tuple[float, float] = (0.0, 0.0)

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the corners of a bounding box."""
        # A bowed plate may extend farther between the corners than at any of them.
        after = np.roll(self.outline, -1, axis=0)
        between = [self.outline + (after - self.outline) * t for t in (0.0, 0.25, 0.5, 0.75)]
        corners = self.frame.place(self._bowed(np.vstack([*between, 0.5 * self.outline, np.zeros((1, 2))])))
        fat = self.thickness()
        return corners.min(axis=0) - fat, corners.max(axis=0) + fat

    def thickness(self) -> float:
        """Return the maximum half thickness, which the outline's inner width and ``most`` limit."""
        inner = float(np.ptp(self.outline, axis=0).min()) / 2
        return max(self.rim, min(self.most, self.rim + self.swell * inner))

    def area(self) -> float:
        """Return the approximate area of both sides."""
        x, y = self.outline.T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))

    def thickened(self, thinnest: float) -> Self:
        """Return the plate with a rim of at least ``thinnest``."""
        return replace(self, rim=max(self.rim, thinnest), most=max(self.most, thinnest))

    def mirrored(self) -> Self:
        """Return the mirror image in the plane z = 0."""
        # The third axis, and the bow with it, is negated, so that the frame stays a rotation.
        return replace(super().mirrored(), bow=(-self.bow[0], -self.bow[1]))

    def _scaled(self, size: float) -> Self:
        bow = (self.bow[0] / size, self.bow[1] / size)
        return replace(self, outline=self.outline * size, rim=self.rim * size, most=self.most * size, bow=bow)

    def distance(self, axes: Axes) -> Volume:
        """Return the signed distance, which is exact near the surface.

        Beyond `_BAND` times the outline's extent from the plane, it is only the distance to the plane, so
        blends must not be wider than that.
        """
        u, v, w = np.broadcast_arrays(*self._local(axes))
        bu, bv = (np.float32(b) for b in self.bow)
        steep = np.sqrt(1 + (bu * u) ** 2 + (bv * v) ** 2)
        across = np.abs(w - (bu * u * u + bv * v * v) / 2) / steep
        distance: Volume = across - np.float32(self.thickness())
        near = distance < _BAND * float(np.ptp(self.outline, axis=0).max())
        flat = outline_distance(self.outline, u[near], v[near])
        half = np.minimum(self.rim - self.swell * np.minimum(flat + self.rim, 0), self.most)
        # The outline is shrunk by the rim and then dilated by a ball of that radius.
        beside, above = flat + np.float32(self.rim), across[near] - (half - np.float32(self.rim))
        outside = np.hypot(np.maximum(beside, 0), np.maximum(above, 0))
        distance[near] = outside + np.minimum(np.maximum(beside, above), 0) - np.float32(self.rim)
        return distance

    def _bowed(self, flat: Doubles) -> Doubles:
        across = (flat**2 @ np.array(self.bow)) / 2
        return np.column_stack([flat, across])


def outline_distance(outline: Doubles, u: Volume, v: Volume) -> Volume:
    """Return the signed distance of points to a closed polygon, negative inside.

    It is the minimum distance to an edge, with the sign given by the number of crossed edges (Quilez, "2D
    distance functions").

    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> outline_distance(square, np.float32([1, 3]), np.float32([1, 1])).tolist()
    [-1.0, 1.0]
    """
    square = np.full(u.shape, np.inf, np.float32)
    inside = np.zeros(u.shape, np.bool_)
    ends = outline.astype(np.float32)
    for (ax, ay), (bx, by) in zip(ends, np.roll(ends, -1, axis=0), strict=True):
        ex, ey, dx, dy = bx - ax, by - ay, u - ax, v - ay
        t = np.clip((dx * ex + dy * ey) / max(ex * ex + ey * ey, np.float32(1e-12)), 0, 1)
        np.minimum(square, (dx - t * ex) ** 2 + (dy - t * ey) ** 2, out=square)
        inside ^= ((v >= ay) != (v >= by)) & ((dx * ey < dy * ex) == (by > ay))
    return np.where(inside, -np.sqrt(square), np.sqrt(square))


def rounded(corners: Sequence[tuple[float, float]], times: int = 2) -> Doubles:
    """Return a closed outline after corner cutting (Chaikin, 1974); repeated corners stay sharper."""
    points = np.array(corners, dtype=np.float64)
    for _ in range(times):
        after = np.roll(points, -1, axis=0)
        points = np.stack([0.75 * points + 0.25 * after, 0.25 * points + 0.75 * after], 1).reshape(-1, 2)
    return points
