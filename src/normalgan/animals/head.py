"""Heads, and ornaments in whatever frame they grow."""

import numpy as np

from normalgan.animals.chain import Frame, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.species import Build, Head, Ornament, Row
from normalgan.animals.sweep import Floats, Sweep

FACE = 0.4  # share of the head's length, from the poll, behind which the muzzle's length changes nothing


def loft(rows: tuple[Row, ...]) -> tuple[Floats, Floats, Floats]:
    """Return points (n, 3), radii (n,) and widths (n,) of stations (x, top, bottom, half width)."""
    x, top, bottom, wide = np.array(rows).T
    points = np.column_stack([x, (top + bottom) / 2, np.zeros(len(x))])
    return points, (top - bottom) / 2, wide


def stretch(x: Floats, muzzle: float) -> Floats:
    """Return positions along the head with the face in front of the eyes stretched."""
    stretched: Floats = x + (muzzle - 1) * np.maximum(x - FACE, 0)
    return stretched


def skull(head: Head, build: Build, frame: Frame) -> Part:
    """Return the head without its ornaments; ``frame`` is that of the head, in the world."""
    points, radii, widths = loft(head.rows)
    points[:, 0] = stretch(points[:, 0], build.muzzle)
    size = head.length * build.head
    placed = frame.place(points * size)
    sides = np.tile(frame.rotation[:, 2], (len(points), 1))
    cut = (placed[-1], frame.rotation[:, 0]) if head.flat else None
    return Part((Sweep(placed, radii * size, widths * size, sides, cut),), blend=0.1 * head.length)


def ornament(
    item: Ornament, size: float, build: Build, frame: Frame, rng: np.random.Generator, muzzle: float = 1.0
) -> Part:
    """Return an ornament, both sides of it if mirrored.

    Args:
        item: what it is.
        size: the unit of its rows.
        build: the individual.
        frame: what it grows on.
        rng: for its swivel, drawn once a side.
        muzzle: how much the face is stretched; 1 on the body.
    """
    rows = np.array(item.rows)
    points, radii, widths = rows[:, :3], rows[:, 3] * size, rows[:, 4] * size
    factor = 1.0 if item.scale == "head" else float(getattr(build, item.scale))
    pivot = points[0] if item.pivot is None else np.array(item.pivot)
    points = pivot + (points - pivot) * factor
    points = np.column_stack([stretch(points[:, 0], muzzle), points[:, 1:]])
    sweeps = []
    for sign in (1.0, -1.0) if item.mirror else (1.0,):
        turn = pitch(rng.normal(0, 0.5) * item.swivel) @ yaw(rng.normal(0, 0.5) * item.swivel)
        flip = np.diag([1.0, 1.0, sign])
        turned = (pivot + (points - pivot) @ turn.T) @ flip
        placed = frame.place(turned * size)
        side = frame.rotation @ flip @ turn @ np.array(item.side)
        cut = None
        if item.cut:
            last = placed[-1] - placed[-2]
            cut = (placed[-1], last / np.linalg.norm(last))
        sweeps.append(Sweep(placed, radii, widths, np.tile(side, (len(points), 1)), cut))
    return Part(tuple(sweeps), item.blend, item.carve, item.ripple)
