"""Compound blobs, for what has no name."""

from dataclasses import dataclass

import numpy as np

from normalgan.animals.frames import Floats, pitch, roll, yaw
from normalgan.animals.parts import Part, Ripple, ball, block, both, fuse, ring, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import Shape

__all__ = ["blob", "creature"]

_KINDS = ("ball", "ball", "rod", "rod", "cone", "block", "ring", "worm")
_INNER = 0.5  # share of its radii within which others may grow out of a piece; dents do not reach so deep


@dataclass(frozen=True, eq=False)
class _Piece:
    """A solid, and points (n, 3) inside it that others can be rooted in."""

    shape: Shape
    roots: Floats


def blob(pose: str, rng: Rng) -> list[Part]:
    """Return a lopsided compound."""
    return _grown(rng, both_sides=False)


def creature(pose: str, rng: Rng) -> list[Part]:
    """Return a compound that is the same on its right and left."""
    return _grown(rng, both_sides=True)


def _grown(rng: Rng, both_sides: bool) -> list[Part]:
    core = _core(rng, both_sides)
    soft = rng.uniform(0.0, 0.22)
    ripple = None
    if rng.uniform() < 0.15:
        ripple = Ripple(rng.uniform(0.006, 0.02), rng.uniform(0.12, 0.3))
    parts = [fuse(core.shape, ripple=ripple)]
    if rng.uniform() < 0.4:
        parts.append(_dents(core, both_sides, rng))
    pieces = [core]
    for _ in range(int(rng.integers(2, 6) if both_sides else rng.integers(3, 8))):
        parent = pieces[int(rng.integers(len(pieces)))]
        root = parent.roots[int(rng.integers(len(parent.roots)))]
        size = rng.uniform(0.5, 1.0) * 0.85 ** (len(pieces) // 3)
        # Only of the core is a root that is brought to the middle still inside.
        middle = both_sides and parent is core and bool(rng.uniform() < 0.45)
        piece = _grow_piece(str(rng.choice(_KINDS)), root * [1, 1, 0] if middle else root, size, middle, rng)
        shapes = both(piece.shape) if both_sides else (piece.shape,)
        parts.append(fuse(*shapes, blend=soft * size * rng.uniform(0.4, 1.2)))
        pieces.append(piece)
    return parts


def _core(rng: Rng, both_sides: bool) -> _Piece:
    radii = rng.uniform(0.24, 0.5, 3)
    turn = pitch(rng.uniform(-90, 90))
    if not both_sides:
        turn = yaw(rng.uniform(0, 360)) @ turn
    boxy = rng.uniform() < 0.25
    shape = block([0, 0, 0], radii, rng.uniform(0.05, 0.25), turn) if boxy else ball([0, 0, 0], radii, turn)
    within = rng.normal(size=(12, 3))
    within *= _INNER / np.linalg.norm(within, axis=1, keepdims=True)
    return _Piece(shape, (within * radii) @ turn.T)


def _dents(core: _Piece, both_sides: bool, rng: Rng) -> Part:
    """Return hollows about points of the core's surface, too shallow to reach its roots."""
    dents = []
    for root in core.roots[: int(rng.integers(1, 4))]:
        size = rng.uniform(0.06, 0.11)
        dents.append(ball(root / _INNER, [size, size * rng.uniform(0.8, 1.6), size]))
    return fuse(*(both(*dents) if both_sides else dents), blend=0.06, carve=True)


def _grow_piece(kind: str, root: Floats, size: float, middle: bool, rng: Rng) -> _Piece:
    """Return a piece that holds its root and grows out of it in some direction."""
    way = rng.normal(size=3)
    if middle:
        way[2] = 0.0  # along the mirror
    way /= np.linalg.norm(way)
    turn = yaw(rng.uniform(0, 360)) @ roll(rng.uniform(0, 360))
    if kind == "ball":
        radii = size * rng.uniform(0.3, 0.75, 3)
        centre = root + 0.7 * float(radii.min()) * way
        return _Piece(ball(centre, radii, turn), np.array([centre, centre + 0.5 * (centre - root)]))
    if kind == "block":
        half = size * rng.uniform(0.25, 0.6, 3)
        centre = root + 0.7 * float(half.min()) * way
        return _Piece(block(centre, half, size * rng.uniform(0.04, 0.15), turn), np.array([centre]))
    if kind == "ring":
        major = size * rng.uniform(0.4, 0.65)
        side = np.cross(way, rng.normal(size=3))
        side /= np.linalg.norm(side)
        axes = np.column_stack([way, side, np.cross(way, side)])
        hoop = ring(root + major * way, major, major * rng.uniform(0.22, 0.4), axes)
        return _Piece(hoop, np.array([root + 2 * major * way]))
    tip = root + size * rng.uniform(0.9, 1.4) * way
    thick = size * rng.uniform(0.14, 0.3)
    if kind == "cone":
        return _Piece(tube([root, tip], [1.6 * thick, 0.15 * thick]), np.array([root]))
    if kind == "rod":
        knob = thick * rng.uniform(0.8, 1.5)
        return _Piece(
            tube([root, (root + tip) / 2, tip], [thick, thick, knob]), np.array([tip, (root + tip) / 2])
        )
    bow = np.cross(way, rng.normal(size=3)) * 0.4 * size
    curve = np.array([root, root * 0.7 + tip * 0.3 + bow, root * 0.3 + tip * 0.7 + bow, tip - 0.6 * bow])
    return _Piece(tube(curve, thick * np.array([1.1, 1.0, 0.8, 0.55])), curve[1:3])
