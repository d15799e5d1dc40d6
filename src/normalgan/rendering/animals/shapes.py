"""Short words for the sweeps and frames that body plans are written with."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from normalgan.rendering.animals.chain import Frame
from normalgan.rendering.animals.head import loft
from normalgan.rendering.animals.sweep import Floats, Sweep

Point = Sequence[float]
ACROSS = (0.0, 0.0, 1.0)


def tube(
    points: Sequence[Point] | Floats,
    radii: Sequence[float] | Floats | float,
    widths: Sequence[float] | Floats | float | None = None,
    side: Point | Floats = ACROSS,
) -> Sweep:
    """Return a sweep; round if no ``widths``, the radii along ``side``, are given.

    >>> tube([(0, 0, 0), (1, 0, 0)], 0.1).radii.tolist()
    [0.1, 0.1]
    """
    curve = np.array(points, dtype=np.float64)
    fat = np.broadcast_to(np.array(radii, dtype=np.float64), len(curve)).copy()
    wide = fat if widths is None else np.broadcast_to(np.array(widths, dtype=np.float64), len(curve)).copy()
    return Sweep(curve, fat, wide, np.tile(np.array(side, dtype=np.float64), (len(curve), 1)))


def trunk(rows: Sequence[Point] | Floats) -> Sweep:
    """Return the sweep of stations (x, top, bottom, half width) in the sagittal plane."""
    points, radii, widths = loft(tuple(tuple(float(v) for v in row) for row in rows))
    return Sweep(points, radii, widths, np.tile(np.array(ACROSS), (len(points), 1)))


def carried(sweep: Sweep, frame: Frame, size: float = 1.0) -> Sweep:
    """Return a sweep given in a part's own frame, in units of ``size``, in the world."""
    return replace(
        sweep,
        points=frame.place(sweep.points * size),
        radii=sweep.radii * size,
        widths=sweep.widths * size,
        sides=sweep.sides @ frame.rotation.T,
    )


def both(*sweeps: Sweep) -> tuple[Sweep, ...]:
    """Return sweeps of the right and their images on the left."""
    flip = np.array([1.0, 1.0, -1.0])
    images = [replace(each, points=each.points * flip, sides=each.sides * flip) for each in sweeps]
    return (*sweeps, *images)


def ball(at: Point | Floats, radius: float) -> Sweep:
    """Return a sphere."""
    return tube(np.array([at, at]), radius)


def roll(degrees: float) -> Floats:
    """Return the (3, 3) rotation about x that turns +z, the right, towards +y.

    >>> (roll(90) @ [0, 0, 1]).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def about(pivot: Point | Floats, rotation: Floats) -> Frame:
    """Return the frame that turns the world about a point."""
    fixed = np.array(pivot, dtype=np.float64)
    return Frame(fixed - rotation @ fixed, rotation)


def hinge(start: Floats, end: Floats, upper: float, lower: float, bend: Point = (-1.0, 0.0, 0.0)) -> Floats:
    """Return the joint (3,) between two bones that run from ``start`` to ``end``, bent towards ``bend``.

    Bones too short to reach lie straight, the joint dividing the way as their lengths do.
    """
    way = end - start
    length = float(np.linalg.norm(way))
    along = (length**2 + upper**2 - lower**2) / (2 * length)
    if length >= upper + lower:
        along = length * upper / (upper + lower)
    out = np.array(bend, dtype=np.float64) - (np.array(bend) @ way) / length**2 * way
    height = np.sqrt(max(upper**2 - along**2, 0.0)) if length < upper + lower else 0.0
    joint: Floats = start + way / length * along + out / np.linalg.norm(out) * height
    return joint


def factors(rng: np.random.Generator, spread: float, *names: str) -> dict[str, float]:
    """Draw a factor from ``1 - spread`` to ``1 + spread`` for each name."""
    return {name: float(rng.uniform(1 - spread, 1 + spread)) for name in names}
