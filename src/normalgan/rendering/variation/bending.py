"""Deformations of the whole: scaling, taper, twist and bend, each with its derivative.

A. H. Barr, "Global and local deformations of solid primitives", SIGGRAPH 1984. A deformation maps points (V,
3) to new positions (V, 3) and its Jacobians (V, 3, 3), ``J[i, j] = dx'_i / dx_j``.
"""

from collections.abc import Callable

import numpy as np

from normalgan.arrays import Doubles

__all__ = ["Deformation", "Deformed", "bend", "in_turn", "scale", "taper", "together", "twist"]

Deformed = tuple[Doubles, Doubles]
Deformation = Callable[[Doubles], Deformed]


def scale(points: Doubles, factors: Doubles) -> Deformed:
    """Scale each axis by its own factor.

    >>> scale(np.ones((1, 3)), np.array([2.0, 1.0, 0.5]))[0]
    array([[2. , 1. , 0.5]])
    """
    return points * factors, np.broadcast_to(np.diag(factors), (len(points), 3, 3))


def taper(points: Doubles, slope: float) -> Deformed:
    """Scale the second and third axis by ``1 + slope * x``, x along the first."""
    factor = 1 + slope * points[:, 0]
    moved = np.column_stack([points[:, 0], factor * points[:, 1], factor * points[:, 2]])
    jacobian = np.zeros((len(points), 3, 3))
    jacobian[:, 0, 0] = 1.0
    jacobian[:, 1, 1] = jacobian[:, 2, 2] = factor
    jacobian[:, 1:, 0] = slope * points[:, 1:]
    return moved, jacobian


def twist(points: Doubles, rate: float) -> Deformed:
    """Turn about the first axis by ``rate * x`` radians, x along it."""
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
    """Bend the first axis to a circular arc, towards another axis; lengths along the arc are kept.

    Args:
        points: (V, 3).
        curvature: one over the radius of the arc, in radians per unit.
        across: 1 or 2, the axis that the first is bent towards.
    """
    along, side = points[:, 0], points[:, across]
    cos, sin = np.cos(curvature * along), np.sin(curvature * along)
    inner = 1 - curvature * side  # how far an arc at this side is from the middle, in radii
    moved = points.copy()
    # sin(kx) / k and (1 - cos(kx)) / k, by functions that have a limit where the curvature k is 0.
    half = np.sinc(curvature * along / (2 * np.pi))
    moved[:, 0] = along * np.sinc(curvature * along / np.pi) - sin * side
    moved[:, across] = curvature * along**2 / 2 * half**2 + cos * side
    jacobian = np.zeros((len(points), 3, 3))
    jacobian[:, 3 - across, 3 - across] = 1.0
    jacobian[:, 0, 0], jacobian[:, 0, across] = cos * inner, -sin
    jacobian[:, across, 0], jacobian[:, across, across] = sin * inner, cos
    return moved, jacobian


def in_turn(points: Doubles, deformations: list[Deformation]) -> Deformed:
    """Return the points moved by several deformations in sequence, and the Jacobians of the whole."""
    jacobian = np.broadcast_to(np.eye(3), (len(points), 3, 3))
    for deform in deformations:
        points, step = deform(points)
        jacobian = step @ jacobian
    return points, jacobian


def together(points: Doubles, deformations: list[Deformation]) -> Deformed:
    """Return the points moved by the sum of several deformations' shifts, and the Jacobians."""
    moved, jacobian = points.copy(), np.tile(np.eye(3), (len(points), 1, 1))
    for deform in deformations:
        alone, step = deform(points)
        moved += alone - points
        jacobian += step - np.eye(3)
    return moved, jacobian
