"""Limbs without a skeleton: longer below the belly, thicker about their own middle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles
from normalgan.rendering.variation.bending import Deformed

__all__ = ["BELLY_SHARE", "BLEND", "REACH", "Middle", "belly", "lengthen", "thicken"]

BELLY_SHARE = 0.4
"""Where sections, going up, first have this share of the widest section's area, the legs end."""
BLEND = 0.08
"""Half the height over which the lengthening of legs sets in, in radii of the object."""
REACH = 3.0
"""Standard deviations beyond which the surface does not count for a middle."""


def belly(points: Doubles, faces: NDArray[np.integer], up: int) -> float:
    """Return the height at which an object's legs end: below it, its level sections are small.

    The area of a section is that of what lies above, projected down (Gauss's theorem; the surface is assumed
    to be closed).

    Args:
        points: (V, 3).
        faces: (F, 3) vertex indices.
        up: the axis that points up.
    """
    a, b, c = (points[faces[:, i]] for i in range(3))
    rising = np.cross(b - a, c - a)[:, up] / 2
    height = (a + b + c)[:, up] / 3
    order = np.argsort(-height)
    section = np.cumsum(rising[order])[::-1]
    wide = section >= BELLY_SHARE * section.max()
    return float(height[order][::-1][np.argmax(wide)])


def lengthen(points: Doubles, up: int, line: float, growth: float) -> Deformed:
    """Stretch the part below a height vertically by ``1 + growth``, with a soft beginning.

    Args:
        points: (V, 3).
        up: the axis that points up.
        line: the height.
        growth: negative to shorten.
    """
    # The integral of a step softened over 2 * BLEND, a parabola between two straight lines.
    below = np.clip((line + BLEND - points[:, up]) / (2 * BLEND), 0.0, None)
    inside = np.minimum(below, 1.0)
    depth = 2 * BLEND * (inside**2 / 2 + (below - inside))
    moved = points.copy()
    moved[:, up] -= growth * depth
    jacobian = np.tile(np.eye(3), (len(points), 1, 1))
    jacobian[:, up, up] += growth * inside
    return moved, jacobian


@dataclass(frozen=True)
class Middle:
    """The mean of the surface near a place, weighted by a Gaussian.

    On a limb thinner than the Gaussian that is a place on the limb's axis, on a trunk thicker than it a
    place just under the skin.

    Args:
        places: (P, 3) of the surface.
        areas: (P,) area of the surface that each point represents.
        width: standard deviation of the Gaussian.
    """

    places: Doubles
    areas: Doubles
    width: float

    @classmethod
    def of(cls, points: Doubles, areas: Doubles, width: float) -> "Middle":
        """Gather a surface, given by points (V, 3) and their areas (V,), in cells of half the width."""
        cells = np.floor((points - points.min(axis=0)) / (width / 2)).astype(np.int64)
        _, cell = np.unique(cells @ [1 << 40, 1 << 20, 1], return_inverse=True)
        total: Doubles = np.bincount(cell, areas).astype(np.float64)
        sums = np.column_stack([np.bincount(cell, areas * points[:, i]) for i in range(3)])
        kept = total > 0
        return cls(sums[kept] / total[kept, None], total[kept], width)

    def at(self, points: Doubles) -> Deformed:
        """Return the middles (V, 3) about points, and how they move with them (V, 3, 3).

        The derivative of such a mean is the covariance under the same Gaussian, over its variance.
        """
        from scipy.spatial import cKDTree  # half a second: only when a mesh is varied

        near = cKDTree(points).sparse_distance_matrix(
            cKDTree(self.places), REACH * self.width, output_type="coo_matrix"
        )
        row, column = np.asarray(near.row), np.asarray(near.col)
        weight = self.areas[column] * np.exp(-((np.asarray(near.data) / self.width) ** 2) / 2)
        offset = self.places[column] - points[row]
        count = len(points)
        total = np.maximum(np.bincount(row, weight, count), 1e-300)

        def mean(values: Doubles) -> Doubles:
            return np.asarray(np.bincount(row, weight * values, count) / total)

        shift = np.column_stack([mean(offset[:, i]) for i in range(3)])
        second = np.array([[mean(offset[:, i] * offset[:, j]) for j in range(3)] for i in range(3)])
        covariance = second.transpose(2, 0, 1) - shift[:, :, None] * shift[:, None, :]
        return points + shift, covariance / self.width**2


def thicken(points: Doubles, middle: Middle, growth: float) -> Deformed:
    """Move points away from the middle of their surface by ``growth`` times their distance from it.

    Args:
        points: (V, 3) of the surface.
        middle: middle of that surface.
        growth: negative to make thinner.
    """
    centres, slopes = middle.at(points)
    return points + growth * (points - centres), np.eye(3) + growth * (np.eye(3) - slopes)
