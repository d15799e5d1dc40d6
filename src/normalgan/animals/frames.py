"""Positions and rotations: frames, and chains of joints."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from normalgan.arrays import Doubles

Volume = NDArray[np.float32]
"""Values on a grid."""
Axes = tuple[Volume, Volume, Volume]
"""Coordinates x, y, z of an open grid, (nx, 1, 1), (1, ny, 1) and (1, 1, nz), or any that broadcast."""


def pitch(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about z that rotates +x towards +y.

    >>> (pitch(90) @ [1, 0, 0]).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def yaw(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about y that rotates +x towards -z, the animal's left.

    >>> (yaw(90) @ [1, 0, 0]).round(6).tolist()
    [0.0, 0.0, -1.0]
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def roll(degrees: float) -> Doubles:
    """Return the (3, 3) rotation about x that raises a hanging limb towards +z, the animal's right.

    >>> bool(np.allclose(roll(90) @ [0, -1, 0], [0, 0, 1]))
    True
    """
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def ray(azimuth: float, elevation: float) -> Doubles:
    """Return the unit vector (3,) +x after rotating it to the right and then upwards, by angles in radians.

    >>> ray(0.0, np.pi / 2).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    level = np.cos(elevation)
    return np.array([np.cos(azimuth) * level, np.sin(elevation), np.sin(azimuth) * level])


def unit(vector: Doubles) -> Doubles:
    """Return a vector (3,) scaled to length 1.

    >>> unit(np.array([3.0, 4.0, 0.0])).tolist()
    [0.6, 0.8, 0.0]
    """
    return vector / np.linalg.norm(vector)


@dataclass(frozen=True, eq=False)
class Frame:
    """The coordinate frame of a part of the body: ``world = origin + rotation @ local``.

    Args:
        origin: (3,) origin.
        rotation: (3, 3) rotation matrix.
    """

    origin: Doubles
    rotation: Doubles

    def place(self, points: ArrayLike) -> Doubles:
        """Convert a local point (3,) or points (n, 3) to world coordinates."""
        return self.origin + np.asarray(points, float) @ self.rotation.T

    def carried(self, frame: "Frame", size: float = 1.0) -> "Frame":
        """Return the frame with its origin scaled by ``size``, then transformed by another frame."""
        return Frame(frame.place(self.origin * size), frame.rotation @ self.rotation)


def spanned(origin: Doubles, first: Doubles, second: Doubles) -> Frame:
    """Return the frame with a given first axis and the second axis as close as possible to a direction.

    Args:
        origin: (3,) origin.
        first: (3,) first axis, of unit length.
        second: (3,) approximate direction of the second axis, not parallel to the first.

    >>> spanned(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([5.0, 2.0, 0.0])).rotation.tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    second = unit(second - (second @ first) * first)
    return Frame(origin, np.column_stack([first, second, np.cross(first, second)]))


def bend(points: Doubles, up: float, left: float) -> tuple[Doubles, Doubles]:
    """Bend a curve evenly along its length, with its first point fixed.

    Args:
        points: (n, 3) stations in the sagittal plane.
        up: upward pitch of the last span in degrees.
        left: rotation of the last span to the left in degrees.

    Returns:
        (n, 3) stations, and (n, 3, 3) rotations from rest at the stations.
    """
    spans = len(points) - 1
    turns = [yaw(left * (i + 1) / spans) @ pitch(up * (i + 1) / spans) for i in range(spans)]
    steps = [turn @ step for turn, step in zip(turns, np.diff(points, axis=0), strict=True)]
    return np.cumsum([points[0], *steps], axis=0), np.array([turns[0], *turns])


def fold(points: Doubles, joints: tuple[int, ...], angles: tuple[float, ...]) -> Doubles:
    """Rotate the bones below each joint in the sagittal plane, from the root outwards.

    Args:
        points: (n, 3) stations.
        joints: indices of the joints among the stations.
        angles: angles in degrees; positive angles move the part below forward.
    """
    moved = points.copy()
    for joint, angle in zip(joints, angles, strict=True):
        moved[joint + 1 :] = moved[joint] + (moved[joint + 1 :] - moved[joint]) @ pitch(angle).T
    return moved


def way_along(points: Doubles) -> Doubles:
    """Return the arc length (n,) of each of the points (n, 3) along the line through them.

    >>> way_along(np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 1.0]])).tolist()
    [0.0, 5.0, 6.0]
    """
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def about(pivot: Sequence[float] | Doubles, rotation: Doubles) -> Frame:
    """Return the frame that rotates the world about a point."""
    fixed = np.array(pivot, dtype=np.float64)
    return Frame(fixed - rotation @ fixed, rotation)


def hinge(
    start: Doubles, end: Doubles, upper: float, lower: float, bend: Sequence[float] = (-1.0, 0.0, 0.0)
) -> Doubles:
    """Return the joint (3,) between two bones from ``start`` to ``end``, displaced towards ``bend``.

    If the bones are too short, the joint is on the straight line and divides it in proportion to their
    lengths.

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
