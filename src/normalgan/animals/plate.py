"""Plates: fins, feathered wings, frills: a flat outline with some thickness, curved if need be."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from normalgan.animals.frames import Frame
from normalgan.animals.solids import MIRROR
from normalgan.animals.sweep import Floats, Volume

__all__ = ["BAND", "Plate", "outline_distance", "rounded"]

BAND = 0.15


@dataclass(frozen=True, eq=False)
class Plate:
    """A closed outline in its own plane, thickened to both sides, with a round rim.

    Args:
        outline: (n, 2) corners in either order, n ≥ 3.
        frame: where the plane is: its own axes are the outline's first, its second, and across.
        rim: half the thickness at the rim.
        swell: growth of half the thickness for each unit of way inwards from the rim.
        most: half the greatest thickness.
        bow: curvature along the first and second axis; positive bends towards the third.
    """

    outline: Floats
    frame: Frame
    rim: float
    swell: float = 0.0
    most: float = np.inf
    bow: tuple[float, float] = (0.0, 0.0)

    def reach(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner, (3,) each, of a box that holds it."""
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
        """Return about how much surface it has, both sides."""
        x, y = self.outline.T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))

    def thickened(self, thinnest: float) -> "Plate":
        """Return it with no rim thinner than ``thinnest``."""
        return replace(self, rim=max(self.rim, thinnest), most=max(self.most, thinnest))

    def mirrored(self) -> "Plate":
        """Return its image on the other side of the plane z = 0."""
        flip = np.diag(MIRROR)
        # The third axis is turned round, so that the frame stays a rotation, and the bow with it.
        frame = Frame(self.frame.origin * MIRROR, flip @ self.frame.rotation @ flip)
        return replace(self, frame=frame, bow=(-self.bow[0], -self.bow[1]))

    def placed(self, frame: Frame, size: float) -> "Plate":
        """Return it scaled by ``size`` and carried along with a frame."""
        inner = Frame(frame.place(self.frame.origin * size), frame.rotation @ self.frame.rotation)
        return Plate(
            self.outline * size,
            inner,
            self.rim * size,
            self.swell,
            self.most * size,
            (self.bow[0] / size, self.bow[1] / size),
        )

    def distance(self, x: Volume, y: Volume, z: Volume) -> Volume:
        """Return the approximate signed distance on an open grid, negative inside, true near the surface.

        Farther than `BAND` times the outline's extent from the plane it is only the distance to the
        plane, so nothing may blend over more than that.

        Args:
            x: (nx, 1, 1) grid coordinates.
            y: (1, ny, 1) grid coordinates.
            z: (1, 1, nz) grid coordinates.

        Returns:
            (nx, ny, nz)
        """
        turn, start = self.frame.rotation.astype(np.float32), self.frame.origin.astype(np.float32)
        px, py, pz = x - start[0], y - start[1], z - start[2]
        u, v, w = (turn[0, i] * px + turn[1, i] * py + turn[2, i] * pz for i in range(3))
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
