"""Solids: ellipsoids, rounded boxes and rings, what sweeps are clumsy at."""

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from normalgan.animals.frames import Frame
from normalgan.animals.sweep import Floats, Volume

__all__ = ["MIRROR", "TINY", "Box", "Ellipsoid", "Ring", "Solid"]

TINY = np.float32(1e-9)
MIRROR = np.array([1.0, 1.0, -1.0])  # what a point is multiplied by to get its image


class Solid(Protocol):
    """A closed body that knows about how far any point is from it."""

    def reach(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner, (3,) each, of a box that holds it."""

    def area(self) -> float:
        """Return about how much surface it has."""

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the approximate signed distance on an open grid, negative inside, true near the surface.

        Args:
            x: (nx, 1, 1) grid coordinates.
            y: (1, ny, 1) grid coordinates.
            z: (1, 1, nz) grid coordinates.

        Returns:
            (nx, ny, nz)
        """

    def thickened(self, thinnest: float) -> "Solid":
        """Return it with no radius below ``thinnest``, under which the grid would lose it."""

    def mirrored(self) -> "Solid":
        """Return its image on the other side of the plane z = 0."""

    def placed(self, frame: Frame, size: float) -> "Solid":
        """Return it scaled by ``size`` and carried along with a frame."""


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """An ellipsoid.

    Args:
        centre: (3,)
        radii: (3,) along its own axes.
        rotation: (3, 3) its axes as columns.
    """

    centre: Floats
    radii: Floats
    rotation: Floats = field(default_factory=lambda: np.eye(3))

    def reach(self) -> tuple[Floats, Floats]:
        """See `Solid`."""
        half = np.linalg.norm(self.rotation * self.radii, axis=1)
        return self.centre - half, self.centre + half

    def area(self) -> float:
        """See `Solid`; Thomsen's formula, within 1.1 %."""
        a, b, c = self.radii**1.6075
        return float(4 * np.pi * ((a * b + b * c + c * a) / 3) ** (1 / 1.6075))

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """See `Solid`; to first order (Quilez, "Ellipsoid SDF", 2008)."""
        u, v, w = _local(self.centre, self.rotation, x, y, z)
        a, b, c = (np.float32(1 / radius) for radius in self.radii)
        u, v, w = u * a, v * b, w * c
        level = np.sqrt(u * u + v * v + w * w + TINY)
        u, v, w = u * a, v * b, w * c
        distance: Volume = level * (level - 1) / np.sqrt(u * u + v * v + w * w + TINY)
        return distance

    def thickened(self, thinnest: float) -> "Ellipsoid":
        """See `Solid`."""
        return replace(self, radii=np.maximum(self.radii, thinnest))

    def mirrored(self) -> "Ellipsoid":
        """See `Solid`."""
        return replace(self, centre=self.centre * MIRROR, rotation=_reflect(self.rotation))

    def placed(self, frame: Frame, size: float) -> "Ellipsoid":
        """See `Solid`."""
        return Ellipsoid(frame.place(self.centre * size), self.radii * size, frame.rotation @ self.rotation)


@dataclass(frozen=True, eq=False)
class Box:
    """A box with rounded edges.

    Args:
        centre: (3,)
        half: (3,) half its lengths along its own axes, rounding included.
        rounding: radius of its edges, at most the least of ``half``.
        rotation: (3, 3) its axes as columns.
    """

    centre: Floats
    half: Floats
    rounding: float
    rotation: Floats = field(default_factory=lambda: np.eye(3))

    def reach(self) -> tuple[Floats, Floats]:
        """See `Solid`."""
        half = np.abs(self.rotation) @ (self.half - self.rounding) + self.rounding
        return self.centre - half, self.centre + half

    def area(self) -> float:
        """See `Solid`; that of the box with sharp edges, a little too much."""
        a, b, c = self.half
        return float(8 * (a * b + b * c + c * a))

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """See `Solid`; exact outside."""
        core = (self.half - self.rounding).astype(np.float32)
        u, v, w = (
            np.abs(p) - h for p, h in zip(_local(self.centre, self.rotation, x, y, z), core, strict=True)
        )
        inside = np.minimum(np.maximum(np.maximum(u, v), w), 0)
        u, v, w = np.maximum(u, 0), np.maximum(v, 0), np.maximum(w, 0)
        distance: Volume = np.sqrt(u * u + v * v + w * w) + inside - np.float32(self.rounding)
        return distance

    def thickened(self, thinnest: float) -> "Box":
        """See `Solid`."""
        return replace(self, half=np.maximum(self.half, thinnest))

    def mirrored(self) -> "Box":
        """See `Solid`."""
        return replace(self, centre=self.centre * MIRROR, rotation=_reflect(self.rotation))

    def placed(self, frame: Frame, size: float) -> "Box":
        """See `Solid`."""
        turned = frame.rotation @ self.rotation
        return Box(frame.place(self.centre * size), self.half * size, self.rounding * size, turned)


@dataclass(frozen=True, eq=False)
class Ring:
    """A torus about its own second axis.

    Args:
        centre: (3,)
        major: radius of the circle in its middle.
        minor: radius of its section.
        rotation: (3, 3) its axes as columns.
    """

    centre: Floats
    major: float
    minor: float
    rotation: Floats = field(default_factory=lambda: np.eye(3))

    def reach(self) -> tuple[Floats, Floats]:
        """See `Solid`."""
        half = self.major * np.sqrt(np.maximum(1 - self.rotation[:, 1] ** 2, 0)) + self.minor
        return self.centre - half, self.centre + half

    def area(self) -> float:
        """See `Solid`."""
        return float(4 * np.pi**2 * self.major * self.minor)

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """See `Solid`; exact."""
        u, v, w = _local(self.centre, self.rotation, x, y, z)
        out = np.sqrt(u * u + w * w) - np.float32(self.major)
        distance: Volume = np.sqrt(out * out + v * v) - np.float32(self.minor)
        return distance

    def thickened(self, thinnest: float) -> "Ring":
        """See `Solid`."""
        return replace(self, minor=max(self.minor, thinnest))

    def mirrored(self) -> "Ring":
        """See `Solid`."""
        return replace(self, centre=self.centre * MIRROR, rotation=_reflect(self.rotation))

    def placed(self, frame: Frame, size: float) -> "Ring":
        """See `Solid`."""
        turned = frame.rotation @ self.rotation
        return Ring(frame.place(self.centre * size), self.major * size, self.minor * size, turned)


def _reflect(rotation: Floats) -> Floats:
    # Each of these bodies is its own image in its own planes: a rotation remains of the reflection.
    reflected: Floats = rotation * MIRROR[:, None] * MIRROR
    return reflected


def _local(
    centre: Floats, rotation: Floats, x: Volume, y: Volume, z: Volume
) -> tuple[Volume, Volume, Volume]:
    """Return the coordinates, (nx, ny, nz) each or open, along the axes of a body."""
    px, py, pz = x - np.float32(centre[0]), y - np.float32(centre[1]), z - np.float32(centre[2])
    if np.array_equal(rotation, np.eye(3)):
        return px, py, pz
    turn = rotation.astype(np.float32)
    u, v, w = (turn[0, i] * px + turn[1, i] * py + turn[2, i] * pz for i in range(3))
    return u, v, w
