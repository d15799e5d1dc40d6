"""Eyes and mouth, set on the surface of the skull whatever its shape."""

import numpy as np

from normalgan.animals.chain import Frame
from normalgan.animals.field import Part
from normalgan.animals.head import loft, stretch
from normalgan.animals.species import Build, Head
from normalgan.animals.sweep import Floats, Sweep

LIP = 0.02  # radius of the groove of the mouth, in units of the head's length
PROUD = 0.007  # how far its middle lies outside the skull, so that it does not cut thin muzzles through


def on_skull(head: Head, x: float, degrees: float) -> Floats:
    """Return the point (3,) on the right half of the skull, in units of its length, seen from its axis.

    The skull is the union of ellipsoids about all stations, so where it tapers steeply its surface lies
    outside the nearest station's section: the ray from the axis is cut with every ellipsoid near.

    Args:
        head: the head.
        x: where along it.
        degrees: 0 to the side, 90 to the crown, -90 under the jaw.
    """
    knots = np.array(head.rows)
    fine = np.column_stack(
        [np.interp(np.linspace(0, len(knots) - 1, 200), np.arange(len(knots)), c) for c in knots.T]
    )
    at, middles, radii, widths = (
        fine[:, 0],
        (fine[:, 1] + fine[:, 2]) / 2,
        (fine[:, 1] - fine[:, 2]) / 2,
        fine[:, 3],
    )
    start = float(np.interp(x, at, middles))
    up, out = np.sin(np.deg2rad(degrees)), np.cos(np.deg2rad(degrees))
    a = (up / radii) ** 2 + (out / widths) ** 2
    b = up * (start - middles) / radii**2
    c = ((x - at) / radii) ** 2 + ((start - middles) / radii) ** 2 - 1
    root = np.sqrt(np.maximum(b * b - a * c, 0))
    far = float(np.max(np.where(b * b >= a * c, (root - b) / a, 0.0)))
    return np.array([x, start + far * up, far * out])


def eyes(head: Head, build: Build, frame: Frame) -> list[Part]:
    """Return shallow sockets to dig and balls to lay in them."""
    x, degrees, radius = head.eye
    at = np.array([on_skull(head, x, degrees), on_skull(head, x + 0.02, degrees)])
    ahead = at + radius * np.array([0.5, 0.1, 0.35])
    sockets = _both(head, build, frame, ahead, 1.15 * radius)
    balls = _both(head, build, frame, at - radius * np.array([0.0, 0.0, 0.35]), radius)
    size = head.length * build.head
    return [Part(sockets, 0.05 * size, carve=True), Part(balls, 0.0)]


def mouth(head: Head, build: Build, frame: Frame) -> Part | None:
    """Return the groove between the lips, to dig, or None if the head has none."""
    if head.mouth is None:
        return None
    corner, degrees = head.mouth
    end = float(head.rows[-1][0])
    along = zip(np.linspace(corner, end, 5), np.linspace(degrees - 12, degrees, 5), strict=True)
    side = np.array([on_skull(head, float(x), float(angle)) for x, angle in along])
    side[:, 2] += PROUD
    points, radii, _ = loft(head.rows)
    # The muzzle ends in half an ellipsoid as deep as it is high.
    ahead, up = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    cap = np.array([end + PROUD + radii[-1] * ahead, points[-1, 1] + radii[-1] * up, 0.0])
    bow = side[-1] * 0.3 + cap * 0.7 + np.array([0.0, 0.0, 0.25 * side[-1, 2]])
    return Part(_both(head, build, frame, np.vstack([side, bow, cap]), LIP), 0.01 * head.length, carve=True)


def _both(head: Head, build: Build, frame: Frame, points: Floats, radius: float) -> tuple[Sweep, ...]:
    size = head.length * build.head
    stretched = np.column_stack([stretch(points[:, 0], build.muzzle), points[:, 1:]])
    fat = np.full(len(points), radius * size)
    sides = np.tile(frame.rotation[:, 2], (len(points), 1))
    return tuple(Sweep(frame.place(stretched * [1, 1, sign] * size), fat, fat, sides) for sign in (1, -1))
