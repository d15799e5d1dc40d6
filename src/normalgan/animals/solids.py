"""Solids: ellipsoids, rounded boxes, rings and plates, what sweeps are clumsy at."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from normalgan.animals.frames import Frame
from normalgan.animals.sweep import Floats, Volume

__all__ = [
    "BAND",
    "MIRROR",
    "TINY",
    "Box",
    "Ellipsoid",
    "Plate",
    "Ring",
    "Solid",
    "outline_distance",
    "rounded",
]

TINY = np.float32(1e-9)
MIRROR = np.array([1.0, 1.0, -1.0])  # what a point is multiplied by to get its image
BAND = 0.15


@dataclass(frozen=True, eq=False)
class Solid(ABC):
    """A closed body that knows about how far any point is from it.

    Args:
        frame: its middle and its own axes.
    """

    frame: Frame

    @abstractmethod
    def reach(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner, (3,) each, of a box that holds it."""

    @abstractmethod
    def area(self) -> float:
        """Return about how much surface it has."""

    @abstractmethod
    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the approximate signed distance on an open grid, negative inside, true near the surface.

        Args:
            x: (nx, 1, 1) grid coordinates.
            y: (1, ny, 1) grid coordinates.
            z: (1, 1, nz) grid coordinates.

        Returns:
            (nx, ny, nz)
        """

    @abstractmethod
    def thickened(self, thinnest: float) -> Self:
        """Return it with no radius below ``thinnest``, under which the grid would lose it."""

    @abstractmethod
    def scaled(self, size: float) -> Self:
        """Return it with its lengths, but not its frame, multiplied by ``size``."""

    def placed(self, frame: Frame, size: float) -> Self:
        """Return it scaled by ``size`` and carried along with a frame."""
        return replace(self.scaled(size), frame=self.frame.carried(frame, size))

    def mirrored(self) -> Self:
        """Return its image on the other side of the plane z = 0."""
        # A body that is its own image in its own planes: a rotation remains of the reflection.
        rotation = self.frame.rotation * MIRROR[:, None] * MIRROR
        return replace(self, frame=Frame(self.frame.origin * MIRROR, rotation))

    def _local(self, x: Volume, y: Volume, z: Volume) -> tuple[Volume, Volume, Volume]:
        """Return the coordinates, (nx, ny, nz) each or open, along the axes of the body."""
        turn, start = self.frame.rotation.astype(np.float32), self.frame.origin.astype(np.float32)
        px, py, pz = x - start[0], y - start[1], z - start[2]
        if np.array_equal(turn, np.eye(3)):
            return px, py, pz
        u, v, w = (turn[0, i] * px + turn[1, i] * py + turn[2, i] * pz for i in range(3))
        return u, v, w


@dataclass(frozen=True, eq=False)
class Ellipsoid(Solid):
    """An ellipsoid.

    Args:
        frame: its middle and its own axes.
        radii: (3,) along these.
    """

    radii: Floats

    def reach(self) -> tuple[Floats, Floats]:
        """Return the corners of a box that holds it."""
        half = np.linalg.norm(self.frame.rotation * self.radii, axis=1)
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return its surface by Thomsen's formula, within 1.1 %."""
        a, b, c = self.radii**1.6075
        return float(4 * np.pi * ((a * b + b * c + c * a) / 3) ** (1 / 1.6075))

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the signed distance to first order (Quilez, "Ellipsoid SDF", 2008)."""
        u, v, w = self._local(x, y, z)
        a, b, c = (np.float32(1 / radius) for radius in self.radii)
        u, v, w = u * a, v * b, w * c
        level = np.sqrt(u * u + v * v + w * w + TINY)
        u, v, w = u * a, v * b, w * c
        distance: Volume = level * (level - 1) / np.sqrt(u * u + v * v + w * w + TINY)
        return distance

    def thickened(self, thinnest: float) -> Self:
        """Return it with no radius below ``thinnest``."""
        return replace(self, radii=np.maximum(self.radii, thinnest))

    def scaled(self, size: float) -> Self:
        """Return it with other radii."""
        return replace(self, radii=self.radii * size)


@dataclass(frozen=True, eq=False)
class Box(Solid):
    """A box with rounded edges.

    Args:
        frame: its middle and its own axes.
        half: (3,) half its lengths along these, rounding included.
        rounding: radius of its edges, at most the least of ``half``.
    """

    half: Floats
    rounding: float

    def reach(self) -> tuple[Floats, Floats]:
        """Return the corners of a box that holds it."""
        half = np.abs(self.frame.rotation) @ (self.half - self.rounding) + self.rounding
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return the surface of the box with sharp edges, a little too much."""
        a, b, c = self.half
        return float(8 * (a * b + b * c + c * a))

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the signed distance, exact outside."""
        core = (self.half - self.rounding).astype(np.float32)
        u, v, w = (np.abs(p) - h for p, h in zip(self._local(x, y, z), core, strict=True))
        inside = np.minimum(np.maximum(np.maximum(u, v), w), 0)
        u, v, w = np.maximum(u, 0), np.maximum(v, 0), np.maximum(w, 0)
        distance: Volume = np.sqrt(u * u + v * v + w * w) + inside - np.float32(self.rounding)
        return distance

    def thickened(self, thinnest: float) -> Self:
        """Return it with no half length below ``thinnest``."""
        return replace(self, half=np.maximum(self.half, thinnest))

    def scaled(self, size: float) -> Self:
        """Return it with other lengths."""
        return replace(self, half=self.half * size, rounding=self.rounding * size)


@dataclass(frozen=True, eq=False)
class Ring(Solid):
    """A torus about its own second axis.

    Args:
        frame: its middle and its own axes.
        major: radius of the circle in its middle.
        minor: radius of its section.
    """

    major: float
    minor: float

    def reach(self) -> tuple[Floats, Floats]:
        """Return the corners of a box that holds it."""
        half = self.major * np.sqrt(np.maximum(1 - self.frame.rotation[:, 1] ** 2, 0)) + self.minor
        return self.frame.origin - half, self.frame.origin + half

    def area(self) -> float:
        """Return its surface."""
        return float(4 * np.pi**2 * self.major * self.minor)

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the signed distance, exact."""
        u, v, w = self._local(x, y, z)
        out = np.sqrt(u * u + w * w) - np.float32(self.major)
        distance: Volume = np.sqrt(out * out + v * v) - np.float32(self.minor)
        return distance

    def thickened(self, thinnest: float) -> Self:
        """Return it with a section no thinner than ``thinnest``."""
        return replace(self, minor=max(self.minor, thinnest))

    def scaled(self, size: float) -> Self:
        """Return it with other radii."""
        return replace(self, major=self.major * size, minor=self.minor * size)


@dataclass(frozen=True, eq=False)
class Plate(Solid):
    """A closed outline in its own plane, thickened to both sides, with a round rim: a fin, wing or frill.

    Args:
        frame: where the plane is: its own axes are the outline's first, its second, and across.
        outline: (n, 2) corners in either order, n ≥ 3.
        rim: half the thickness at the rim.
        swell: growth of half the thickness for each unit of way inwards from the rim.
        most: half the greatest thickness.
        bow: curvature along the first and second axis; positive bends towards the third.
    """

    outline: Floats
    rim: float
    swell: float = 0.0
    most: float = np.inf
    bow: tuple[float, float] = (0.0, 0.0)

    def reach(self) -> tuple[Floats, Floats]:
        """Return the corners of a box that holds it."""
        # Where it is bowed, it may reach farther between the corners than at any of them.
        after = np.roll(self.outline, -1, axis=0)
        between = [self.outline + (after - self.outline) * t for t in (0.0, 0.25, 0.5, 0.75)]
        corners = self.frame.place(self._bowed(np.vstack([*between, 0.5 * self.outline, np.zeros((1, 2))])))
        fat = self.thickness()
        return corners.min(axis=0) - fat, corners.max(axis=0) + fat

    def thickness(self) -> float:
        """Return half the greatest thickness, as the outline's inner width and ``most`` allow."""
        inner = float(np.ptp(self.outline, axis=0).min()) / 2
        return max(self.rim, min(self.most, self.rim + self.swell * inner))

    def area(self) -> float:
        """Return about how much surface both sides have."""
        x, y = self.outline.T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))

    def thickened(self, thinnest: float) -> Self:
        """Return it with no rim thinner than ``thinnest``."""
        return replace(self, rim=max(self.rim, thinnest), most=max(self.most, thinnest))

    def mirrored(self) -> Self:
        """Return its image on the other side of the plane z = 0."""
        # The third axis is turned round, so that the frame stays a rotation, and the bow with it.
        return replace(super().mirrored(), bow=(-self.bow[0], -self.bow[1]))

    def scaled(self, size: float) -> Self:
        """Return it with other lengths, bowed along with them."""
        bow = (self.bow[0] / size, self.bow[1] / size)
        return replace(self, outline=self.outline * size, rim=self.rim * size, most=self.most * size, bow=bow)

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the signed distance, true near the surface.

        Farther than `BAND` times the outline's extent from the plane it is only the distance to the
        plane, so nothing may blend over more than that.
        """
        u, v, w = np.broadcast_arrays(*self._local(x, y, z))
        bu, bv = (np.float32(b) for b in self.bow)
        steep = np.sqrt(1 + (bu * u) ** 2 + (bv * v) ** 2)
        across = np.abs(w - (bu * u * u + bv * v * v) / 2) / steep
        distance: Volume = across - np.float32(self.thickness())
        near = distance < BAND * float(np.ptp(self.outline, axis=0).max())
        flat = outline_distance(self.outline, u[near], v[near])
        half = np.minimum(self.rim - self.swell * np.minimum(flat + self.rim, 0), self.most)
        # The outline shrunk by the rim and then rounded: as if a ball of that radius were moved over it.
        beside, above = flat + np.float32(self.rim), across[near] - (half - np.float32(self.rim))
        outside = np.hypot(np.maximum(beside, 0), np.maximum(above, 0))
        distance[near] = outside + np.minimum(np.maximum(beside, above), 0) - np.float32(self.rim)
        return distance

    def _bowed(self, flat: Floats) -> Floats:
        across = (flat**2 @ np.array(self.bow)) / 2
        return np.column_stack([flat, across])


def outline_distance(outline: Floats, u: Volume, v: Volume) -> Volume:
    """Return the signed distance of points to a closed polygon, negative inside.

    The least distance to an edge, its sign by the number of edges crossed (Quilez, "2D distance functions").

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


def rounded(corners: Sequence[tuple[float, float]], times: int = 2) -> Floats:
    """Return a closed outline with its corners cut (Chaikin, 1974); a corner given twice stays sharper."""
    points = np.array(corners, dtype=np.float64)
    for _ in range(times):
        after = np.roll(points, -1, axis=0)
        points = np.stack([0.75 * points + 0.25 * after, 0.25 * points + 0.75 * after], 1).reshape(-1, 2)
    return points
