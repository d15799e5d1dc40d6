"""Positions and rotations: frames, and chains bent at joints."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from normalgan.arrays import Doubles

__all__ = [
    "Axes",
    "Frame",
    "Volume",
    "about",
    "bend",
    "fold",
    "hinge",
    "pitch",
    "ray",
    "roll",
    "spanned",
    "unit",
    "way_along",
    "yaw",
]

Volume = NDArray[np.float32]
"""Values on a grid."""
Axes = tuple[Volume, Volume, Volume]
"""Coordinates x, y, z of an open grid, (nx, 1, 1), (1, ny, 1) and (1, 1, nz), or of any that broadcast."""


def pitch(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about z that turns +x towards +y.

    >>> (pitch(90) @ [1, 0, 0]).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def yaw(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about y that turns +x towards -z, the animal's left.

    >>> (yaw(90) @ [1, 0, 0]).round(6).tolist()
    [0.0, 0.0, -1.0]
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def roll(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about x that lifts a hanging limb towards +z, the animal's right.

    >>> bool(np.allclose(roll(90) @ [0, -1, 0], [0, 0, 1]))
    True
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def ray(azimuth: float, elevation: float) -> Doubles:
    """Return +x turned to the right and then raised, by angles in radians, (3,).

    >>> ray(0.0, np.pi / 2).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    level = np.cos(elevation)
    return np.array([np.cos(azimuth) * level, np.sin(elevation), np.sin(azimuth) * level])


def unit(vector: Doubles) -> Doubles:
    """Return the vector (3,) of length 1 along another.

    >>> unit(np.array([3.0, 4.0, 0.0])).tolist()
    [0.6, 0.8, 0.0]
    """
    return vector / np.linalg.norm(vector)


@dataclass(frozen=True, eq=False)
class Frame:
    """Where a part of the body is: ``world = origin + rotation @ local``.

    Args:
        origin: (3,)
        rotation: (3, 3)
    """

    origin: Doubles
    rotation: Doubles

    def place(self, points: ArrayLike) -> Doubles:
        """Return a local point (3,), or (n, 3) of them, in the world."""
        return self.origin + np.asarray(points, float) @ self.rotation.T

    def carried(self, frame: "Frame", size: float = 1.0) -> "Frame":
        """Return the frame with its origin scaled by ``size``, then moved with another frame."""
        return Frame(frame.place(self.origin * size), frame.rotation @ self.rotation)


def spanned(origin: Doubles, first: Doubles, second: Doubles) -> Frame:
    """Return the frame whose second axis is as near to a direction as its first one allows.

    Args:
        origin: (3,)
        first: (3,) the first axis, of unit length.
        second: (3,) not along the first.

    >>> spanned(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([5.0, 2.0, 0.0])).rotation.tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    second = unit(second - (second @ first) * first)
    return Frame(origin, np.column_stack([first, second, np.cross(first, second)]))


def bend(points: Doubles, up: float, left: float) -> tuple[Doubles, Doubles]:
    """Bend a curve evenly along its length, its first point fixed.

    Args:
        points: (n, 3) stations in the sagittal plane.
        up: degrees by which the last span is pitched.
        left: degrees by which the last span is turned.

    Returns:
        (n, 3) stations, and (n, 3, 3) rotations from rest at each.
    """
    spans = len(points) - 1
    turns = [yaw(left * (i + 1) / spans) @ pitch(up * (i + 1) / spans) for i in range(spans)]
    steps = [turn @ step for turn, step in zip(turns, np.diff(points, axis=0), strict=True)]
    return np.cumsum([points[0], *steps], axis=0), np.array([turns[0], *turns])


def fold(points: Doubles, joints: tuple[int, ...], angles: tuple[float, ...]) -> Doubles:
    """Rotate the bones beyond each joint about it, from the root outwards, in the sagittal plane.

    Args:
        points: (n, 3)
        joints: indices of points.
        angles: degrees; a positive angle moves the part below forward.
    """
    moved = points.copy()
    for joint, angle in zip(joints, angles, strict=True):
        moved[joint + 1 :] = moved[joint] + (moved[joint + 1 :] - moved[joint]) @ pitch(angle).T
    return moved


def way_along(points: Doubles) -> Doubles:
    """Return how far each of (n, 3) points is along the line through them, (n,), from 0.

    >>> way_along(np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 1.0]])).tolist()
    [0.0, 5.0, 6.0]
    """
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def about(pivot: Sequence[float] | Doubles, rotation: Doubles) -> Frame:
    """Return the frame that turns the world about a point."""
    fixed = np.array(pivot, dtype=np.float64)
    return Frame(fixed - rotation @ fixed, rotation)


def hinge(
    start: Doubles, end: Doubles, upper: float, lower: float, bend: Sequence[float] = (-1.0, 0.0, 0.0)
) -> Doubles:
    """Return the joint (3,) between two bones that run from ``start`` to ``end``, bent towards ``bend``.

    Bones too short to reach lie straight, the joint dividing the way as their lengths do.

    >>> hinge(np.zeros(3), np.array([0.0, -6.0, 0.0]), 5.0, 5.0).tolist()
    [-4.0, -3.0, 0.0]
    """
    way = end - start
    length = float(np.linalg.norm(way))
    along, height = length * upper / (upper + lower), 0.0
    if length < upper + lower:
        along = (length**2 + upper**2 - lower**2) / (2 * length)
        height = float(np.sqrt(max(upper**2 - along**2, 0.0)))
    out = np.array(bend, dtype=np.float64)
    return start + way / length * along + unit(out - (out @ way) / length**2 * way) * height
