"""Local deformations: bumps and hollows, and parts blown up or shrunk."""

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.variation.bending import Deformed

__all__ = ["bump", "swell"]


def bump(points: Doubles, centre: Doubles, width: float, shift: Doubles) -> Deformed:
    """Shift the surroundings of a place, the more the nearer they are, by a Gaussian.

    Args:
        points: (V, 3).
        centre: (3,) the place.
        width: standard deviation of the Gaussian.
        shift: (3,) how far the place itself moves.
    """
    offset = points - centre
    share = _gaussian(offset, width)
    slope = -share[:, None] * offset / width**2
    return points + share[:, None] * shift, np.eye(3) + shift[:, None] * slope[:, None, :]


def swell(points: Doubles, centre: Doubles, width: float, growth: float) -> Deformed:
    """Blow up the surroundings of a place: near it lengths grow by ``1 + growth``, far from it nothing moves.

    Args:
        points: (V, 3).
        centre: (3,) the place.
        width: standard deviation of the Gaussian by which the growth falls off.
        growth: negative to shrink.
    """
    offset = points - centre
    share = growth * _gaussian(offset, width)
    outer = offset[:, :, None] * offset[:, None, :] / width**2
    return points + share[:, None] * offset, np.eye(3) + share[:, None, None] * (np.eye(3) - outer)


def _gaussian(offset: Doubles, width: float) -> Doubles:
    return np.asarray(np.exp(-np.einsum("vc,vc->v", offset, offset) / (2 * width**2)))
