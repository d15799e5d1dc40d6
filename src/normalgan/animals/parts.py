"""Parts that are blended to a body, and helpers to build them: balls, blocks, tubes, symmetric pairs."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from normalgan.animals.frames import Frame, unit
from normalgan.animals.shapes import Box, Cut, Ellipsoid, Ring, Shape, Sweep
from normalgan.animals.tables import Number
from normalgan.arrays import Doubles

_SIDE = (0.0, 0.0, 1.0)


class Ripple(NamedTuple):
    """Bumps on a surface: fleece, fur, leaves.

    Args:
        height: height of the highest point.
        wavelength: approximate distance between bumps.
    """

    height: Number
    wavelength: Number


@dataclass(frozen=True, eq=False)
class Part:
    """A sharp union of shapes, which is then blended with the parts before it.

    Args:
        shapes: shapes of the part.
        blend: width of the blending zone between the part and the rest; 0 for a sharp seam.
        carve: whether to subtract the part instead of adding it.
        ripple: bumps on the surface; None for a smooth surface.
    """

    shapes: tuple[Shape, ...]
    blend: float
    carve: bool = False
    ripple: Ripple | None = None

    def reach(self) -> tuple[Doubles, Doubles]:
        """Return the lowest and highest corner, (3,) each, of a bounding box."""
        boxes = [shape.reach() for shape in self.shapes]
        return np.stack([low for low, _ in boxes]).min(0), np.stack([high for _, high in boxes]).max(0)

    def thickened(self, thinnest: float) -> Self:
        """Return a copy with radii of at least ``thinnest``."""
        return replace(self, shapes=tuple(shape.thickened(thinnest) for shape in self.shapes))

    def placed(self, frame: Frame, size: float = 1.0) -> Self:
        """Return the part and its blend scaled by ``size`` and placed in a frame."""
        shapes = tuple(shape.placed(frame, size) for shape in self.shapes)
        ripple = None if self.ripple is None else Ripple(*(size * length for length in self.ripple))
        return replace(self, shapes=shapes, blend=self.blend * size, ripple=ripple)


def by(start: Doubles, x: float, y: float, z: float) -> Doubles:
    """Return the point at a given offset from another.

    >>> by(np.array([1.0, 2.0, 3.0]), 0.5, 0, 0).tolist()
    [1.5, 2.0, 3.0]
    """
    moved_on: Doubles = start + np.array([x, y, z])
    return moved_on


def in_space(points: ArrayLike) -> Doubles:
    """Return points (..., 3), with z = 0 (the middle plane) for points without z.

    >>> in_space((1, 2)).tolist()
    [1.0, 2.0, 0.0]
    """
    given = np.array(points, float)
    return given if given.shape[-1] == 3 else np.insert(given, 2, 0.0, axis=-1)


def ball(at: ArrayLike, radii: ArrayLike, turn: Doubles | None = None) -> Ellipsoid:
    """Return a sphere, or an ellipsoid if three radii are given."""
    return Ellipsoid(_frame(at, turn), np.broadcast_to(np.array(radii, float), 3).copy())


def block(at: ArrayLike, half: ArrayLike, rounding: float, turn: Doubles | None = None) -> Box:
    """Return a box with rounded edges and half lengths ``half``."""
    sides = np.array(half, float)
    return Box(_frame(at, turn), sides, min(rounding, float(sides.min())))


def ring(at: ArrayLike, major: float, minor: float, turn: Doubles | None = None) -> Ring:
    """Return a torus, horizontal unless rotated by ``turn``."""
    return Ring(_frame(at, turn), major, minor)


def tube(
    points: ArrayLike,
    radii: ArrayLike,
    widths: ArrayLike | None = None,
    side: ArrayLike = _SIDE,
    flat: bool = False,
) -> Sweep:
    """Return a sweep.

    Args:
        points: (n, 3) points of the curve, or (n, 2) for a curve in the middle plane.
        radii: one or n radii of the section across ``side``.
        widths: one or n radii along ``side``; None for round sections.
        side: (3,) or (n, 3) direction of the widths.
        flat: whether the end is cut off flat at the last point.
    """
    curve = in_space(points)
    count = len(curve)
    thick = np.broadcast_to(np.array(radii, float), count)
    wide = thick if widths is None else np.broadcast_to(np.array(widths, float), count)
    sides = np.broadcast_to(np.array(side, float), (count, 3))
    if flat and count == 2:  # only the last third of a sweep is cut, which needs more than two points
        ends = np.column_stack([curve, thick, wide, sides])
        rows = np.linspace(ends[0], ends[1], 4)
        curve, thick, wide, sides = rows[:, :3], rows[:, 3], rows[:, 4], rows[:, 5:]
    cut = Cut(curve[-1], unit(curve[-1] - curve[-2])) if flat else None
    return Sweep(curve, thick, wide, sides, cut)


def fuse(*shapes: Shape, blend: float = 0.0, carve: bool = False, ripple: Ripple | None = None) -> Part:
    """Return a part made of shapes."""
    return Part(shapes, blend, carve, ripple)


def on_side(shape: Shape, right: bool) -> Shape:
    """Return a shape of the right side, or its mirror image on the left."""
    return shape if right else shape.mirrored()


def both(*shapes: Shape) -> tuple[Shape, ...]:
    """Return the shapes and their mirror images."""
    return (*shapes, *(shape.mirrored() for shape in shapes))


def pair(*shapes: Shape, blend: float = 0.0, carve: bool = False) -> Part:
    """Return a part made of the shapes and their mirror images."""
    return fuse(*both(*shapes), blend=blend, carve=carve)


def carried(parts: Iterable[Part], frame: Frame, size: float = 1.0) -> list[Part]:
    """Return parts and their blends scaled by ``size`` and placed in a frame."""
    return [part.placed(frame, size) for part in parts]


def _frame(at: ArrayLike, turn: Doubles | None) -> Frame:
    return Frame(in_space(at), np.eye(3) if turn is None else turn)
