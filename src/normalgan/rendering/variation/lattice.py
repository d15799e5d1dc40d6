"""Free-form deformation: a lattice of control points about an object, pulled out of place."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.variation.bending import Deformed

__all__ = ["CHOOSE", "DEGREE", "free_form"]

DEGREE = 3
CHOOSE = np.array([1.0, 3.0, 3.0, 1.0])


def free_form(points: Doubles, low: Doubles, high: Doubles, pulls: Doubles) -> Deformed:
    """Move points as a lattice of control points about them is pulled.

    Tensor-product Bernstein polynomials of degree 3 (Sederberg and Parry, "Free-form deformation of solid
    geometric models", SIGGRAPH 1986), added to a point's position, so that without pulls nothing moves.

    Args:
        points: (V, 3), of the last deformation.
        low: (3,) corner of the lattice.
        high: (3,) opposite corner.
        pulls: (4, 4, 4, 3) how far each control point is pulled.
    """
    size = np.maximum(high - low, 1e-9)  # flat objects have no thickness
    weights, slopes = zip(*(_bernstein(part) for part in ((points - low) / size).T), strict=True)

    def blend(i: Doubles, j: Doubles, k: Doubles) -> Doubles:
        across = np.einsum("vk,ijkc->vijc", k, pulls)
        return np.asarray(np.einsum("vi,vj,vijc->vc", i, j, across, optimize=True))

    jacobian = np.empty((len(points), 3, 3))
    for axis in range(3):
        factors = [slopes[n] / size[n] if n == axis else weights[n] for n in range(3)]
        jacobian[:, :, axis] = blend(*factors)
    return points + blend(*weights), jacobian + np.eye(3)


def _bernstein(share: Doubles) -> Deformed:
    """Return the (V, 4) Bernstein polynomials of degree 3 at places along an axis, and their slopes."""
    k = np.arange(DEGREE + 1)
    t, rest = share[:, None], 1 - share[:, None]
    # 0 ** 0 is 1, and where the exponent would be -1 its factor is 0.
    slopes = CHOOSE * (
        k * t ** np.maximum(k - 1, 0) * rest ** (DEGREE - k)
        - (DEGREE - k) * t**k * rest ** np.maximum(DEGREE - k - 1, 0)
    )
    return CHOOSE * t**k * rest ** (DEGREE - k), slopes
