"""Deformations of a surface, each with its derivative.

A deformation maps points (V, 3) to new positions (V, 3) and Jacobians (V, 3, 3), ``J[i, j] = dx'_i /
dx_j``. Scaling, taper, twist and bend follow A. H. Barr, "Global and local deformations of solid
primitives", SIGGRAPH 1984.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles

Deformed = tuple[Doubles, Doubles]
Deformation = Callable[[Doubles], Deformed]


def scale(points: Doubles, factors: Doubles) -> Deformed:
    """Scale each axis by its own factor.

    >>> scale(np.ones((1, 3)), np.array([2.0, 1.0, 0.5]))[0]
    array([[2. , 1. , 0.5]])
    """
    return points * factors, np.broadcast_to(np.diag(factors), (len(points), 3, 3))


def taper(points: Doubles, slope: float) -> Deformed:
    """Scale the second and third axis by ``1 + slope * x``, where x is the first coordinate."""
    factor = 1 + slope * points[:, 0]
    moved = np.column_stack([points[:, 0], factor * points[:, 1], factor * points[:, 2]])
    jacobian = np.zeros((len(points), 3, 3))
    jacobian[:, 0, 0] = 1.0
    jacobian[:, 1, 1] = jacobian[:, 2, 2] = factor
    jacobian[:, 1:, 0] = slope * points[:, 1:]
    return moved, jacobian


def twist(points: Doubles, rate: float) -> Deformed:
    """Rotate about the first axis by ``rate * x`` radians, where x is the first coordinate."""
    x, y, z = points.T
    cos, sin = np.cos(rate * x), np.sin(rate * x)
    turned_y, turned_z = cos * y - sin * z, sin * y + cos * z
    jacobian = np.zeros((len(points), 3, 3))
    jacobian[:, 0, 0] = 1.0
    jacobian[:, 1, 0], jacobian[:, 2, 0] = -rate * turned_z, rate * turned_y
    jacobian[:, 1, 1] = jacobian[:, 2, 2] = cos
    jacobian[:, 1, 2], jacobian[:, 2, 1] = -sin, sin
    return np.column_stack([x, turned_y, turned_z]), jacobian


def bend(points: Doubles, curvature: float, across: int) -> Deformed:
    """Bend the first axis to a circular arc towards another axis, preserving lengths along the arc.

    Args:
        points: (V, 3) points.
        curvature: reciprocal radius of the arc, in radians per unit.
        across: index of the axis to bend towards, 1 or 2.
    """
    along, side = points[:, 0], points[:, across]
    cos, sin = np.cos(curvature * along), np.sin(curvature * along)
    inner = 1 - curvature * side  # distance of an arc on this side from the middle, in radii
    moved = points.copy()
    # sin(kx) / k and (1 - cos(kx)) / k, written such that they are defined for curvature k = 0.
    half = np.sinc(curvature * along / (2 * np.pi))
    moved[:, 0] = along * np.sinc(curvature * along / np.pi) - sin * side
    moved[:, across] = curvature * along**2 / 2 * half**2 + cos * side
    jacobian = np.zeros((len(points), 3, 3))
    jacobian[:, 3 - across, 3 - across] = 1.0
    jacobian[:, 0, 0], jacobian[:, 0, across] = cos * inner, -sin
    jacobian[:, across, 0], jacobian[:, across, across] = sin * inner, cos
    return moved, jacobian


def in_turn(points: Doubles, deformations: list[Deformation]) -> Deformed:
    """Return the points after several successive deformations, and the Jacobians of their composition."""
    jacobian = np.broadcast_to(np.eye(3), (len(points), 3, 3))
    for deform in deformations:
        points, step = deform(points)
        jacobian = step @ jacobian
    return points, jacobian


def together(points: Doubles, deformations: list[Deformation]) -> Deformed:
    """Return the points moved by the sum of the displacements of several deformations, and the Jacobians."""
    moved, jacobian = points.copy(), np.tile(np.eye(3), (len(points), 1, 1))
    for deform in deformations:
        alone, step = deform(points)
        moved += alone - points
        jacobian += step - np.eye(3)
    return moved, jacobian


def bump(points: Doubles, centre: Doubles, width: float, shift: Doubles) -> Deformed:
    """Shift the surroundings of a centre with Gaussian falloff.

    Args:
        points: (V, 3) points.
        centre: (3,) centre of the shift.
        width: standard deviation of the Gaussian.
        shift: (3,) displacement of the centre.
    """
    offset = points - centre
    fraction = _gaussian(offset, width)
    slope = -fraction[:, None] * offset / width**2
    return points + fraction[:, None] * shift, np.eye(3) + shift[:, None] * slope[:, None, :]


def swell(points: Doubles, centre: Doubles, width: float, growth: float) -> Deformed:
    """Inflate the surroundings of a centre by ``1 + growth`` with Gaussian falloff.

    Args:
        points: (V, 3) points.
        centre: (3,) centre of the inflation.
        width: standard deviation of the Gaussian.
        growth: relative increase of lengths at the centre; negative to shrink.
    """
    offset = points - centre
    factor = growth * _gaussian(offset, width)
    outer = offset[:, :, None] * offset[:, None, :] / width**2
    return points + factor[:, None] * offset, np.eye(3) + factor[:, None, None] * (np.eye(3) - outer)


def _gaussian(offset: Doubles, width: float) -> Doubles:
    return np.asarray(np.exp(-np.einsum("vc,vc->v", offset, offset) / (2 * width**2)))


_DEGREE = 3
_CHOOSE = np.array([1.0, 3.0, 3.0, 1.0])


def free_form(points: Doubles, low: Doubles, high: Doubles, pulls: Doubles) -> Deformed:
    """Move points with a lattice of control points around them.

    Displacements are tensor products of Bernstein polynomials of degree 3 (Sederberg and Parry, "Free-form
    deformation of solid geometric models", SIGGRAPH 1986), so points do not move if all pulls are 0.

    Args:
        points: (V, 3) points.
        low: (3,) corner of the lattice.
        high: (3,) opposite corner.
        pulls: (4, 4, 4, 3) displacements of the control points.
    """
    size = np.maximum(high - low, 1e-9)  # flat objects have zero thickness
    weights, slopes = zip(*(_bernstein(part) for part in ((points - low) / size).T), strict=True)

    def blend(i: Doubles, j: Doubles, k: Doubles) -> Doubles:
        across = np.einsum("vk,ijkc->vijc", k, pulls)
        return np.asarray(np.einsum("vi,vj,vijc->vc", i, j, across, optimize=True))

    jacobian = np.empty((len(points), 3, 3))
    for axis in range(3):
        factors = [slopes[n] / size[n] if n == axis else weights[n] for n in range(3)]
        jacobian[:, :, axis] = blend(*factors)
    return points + blend(*weights), jacobian + np.eye(3)


def _bernstein(fraction: Doubles) -> Deformed:
    """Return values and derivatives (V, 4) of the cubic Bernstein polynomials at positions along an axis."""
    k = np.arange(_DEGREE + 1)
    t, rest = fraction[:, None], 1 - fraction[:, None]
    # 0 ** 0 is 1, and terms with an exponent of -1 have a factor of 0.
    slopes = _CHOOSE * (
        k * t ** np.maximum(k - 1, 0) * rest ** (_DEGREE - k)
        - (_DEGREE - k) * t**k * rest ** np.maximum(_DEGREE - k - 1, 0)
    )
    return _CHOOSE * t**k * rest ** (_DEGREE - k), slopes


_BELLY_FRACTION = 0.4
"""Fraction of the largest cross section's area at which the legs end, going upwards."""
_BLEND = 0.08
"""Half of the transition height for lengthening legs, in radii of the object."""
_CUTOFF = 3.0
"""Cutoff of the Gaussian for middles, in standard deviations."""


def belly(points: Doubles, faces: NDArray[np.integer], up: int) -> float:
    """Return the height at which an object's legs end, below which horizontal cross sections are small.

    The area of a cross section is the projected area of the surface above it (Gauss's theorem for a closed
    surface).

    Args:
        points: (V, 3) points.
        faces: (F, 3) vertex indices.
        up: index of the axis that points up.
    """
    a, b, c = (points[faces[:, i]] for i in range(3))
    rising = np.cross(b - a, c - a)[:, up] / 2
    height = (a + b + c)[:, up] / 3
    order = np.argsort(-height)
    section = np.cumsum(rising[order])[::-1]
    wide = section >= _BELLY_FRACTION * section.max()
    return float(height[order][::-1][np.argmax(wide)])


def lengthen(points: Doubles, up: int, line: float, growth: float) -> Deformed:
    """Stretch the part below a height vertically by ``1 + growth``, with a smooth transition.

    Args:
        points: (V, 3) points.
        up: index of the axis that points up.
        line: height below which the object is stretched.
        growth: relative increase of lengths; negative to shorten.
    """
    # The integral of a step smoothed over 2 * BLEND is a parabola between two straight lines.
    below = np.clip((line + _BLEND - points[:, up]) / (2 * _BLEND), 0.0, None)
    inside = np.minimum(below, 1.0)
    depth = 2 * _BLEND * (inside**2 / 2 + (below - inside))
    moved = points.copy()
    moved[:, up] -= growth * depth
    jacobian = np.tile(np.eye(3), (len(points), 1, 1))
    jacobian[:, up, up] += growth * inside
    return moved, jacobian


@dataclass(frozen=True)
class Middle:
    """The local mean position of a surface, weighted by a Gaussian.

    On a limb thinner than the Gaussian, this is a point on the limb's axis. On a thicker trunk, it is a
    point just below the surface.

    Args:
        places: (P, 3) points on the surface.
        areas: (P,) area of the surface that each point represents.
        width: standard deviation of the Gaussian.
    """

    places: Doubles
    areas: Doubles
    width: float

    @classmethod
    def of(cls, points: Doubles, areas: Doubles, width: float) -> "Middle":
        """Aggregate a surface, given by points (V, 3) and their areas (V,), in cells of half the width."""
        cells = np.floor((points - points.min(axis=0)) / (width / 2)).astype(np.int64)
        _, cell = np.unique(cells @ [1 << 40, 1 << 20, 1], return_inverse=True)
        total: Doubles = np.bincount(cell, areas).astype(np.float64)
        sums = np.column_stack([np.bincount(cell, areas * points[:, i]) for i in range(3)])
        kept = total > 0
        return cls(sums[kept] / total[kept, None], total[kept], width)

    def at(self, points: Doubles) -> Deformed:
        """Return the middles (V, 3) around points, and their derivatives by the points (V, 3, 3).

        The derivative is the covariance under the same Gaussian divided by its variance.
        """
        from scipy.spatial import cKDTree  # takes half a second to import, only needed to vary meshes

        near = cKDTree(points).sparse_distance_matrix(
            cKDTree(self.places), _CUTOFF * self.width, output_type="coo_matrix"
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
        points: (V, 3) points on the surface.
        middle: middle of the surface.
        growth: relative increase of the thickness; negative to make thinner.
    """
    centres, slopes = middle.at(points)
    return points + growth * (points - centres), np.eye(3) + growth * (np.eye(3) - slopes)
