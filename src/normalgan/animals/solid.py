"""Solid: what the field asks of a closed body."""

from typing import Protocol

from normalgan.animals.chain import Frame
from normalgan.animals.sweep import Floats, Volume


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
