"""Ellipsoids seen orthographically, whose maps are known exactly, and drawings of them."""

import mesh_shapes
import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes import Stroke


def ellipsoid(inverse: Doubles, size: int = 128) -> Maps:
    """Return the maps of the height field z = sqrt(r² - |inverse (q - c)|²), c the centre, r a quarter side.

    With the identity it is a sphere; with the inverse of a matrix A, the sphere whose picture A distorts.
    ``q`` has y down.
    """
    grid = (np.arange(size) + 0.5) / size - 0.5
    q = np.stack(np.meshgrid(grid, grid), axis=-1)
    p = q @ inverse.T
    inside = 0.25**2 - (p * p).sum(axis=-1)
    mask = inside > 0
    z = np.sqrt(np.maximum(inside, 0))
    gradient = p @ inverse  # of |p|² / 2, hence of -z²/2: the normal is (gradient, z), y down
    normal = np.stack([gradient[..., 0], -gradient[..., 1], z], axis=-1)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    normal[~mask] = 0
    return Maps(normal.astype(np.float32), np.where(mask, 2 - z, np.inf).astype(np.float32), mask)


def rim(size: int = 128) -> Stroke:
    """Return the outline of the sphere, a closed stroke."""
    turn = np.linspace(0, 2 * np.pi, 361)
    points = size * (0.5 + 0.25 * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    points[-1] = points[0]
    return Stroke.even(points, 1.25)


def drawing(size: int = 128) -> list[Stroke]:
    """Return an outline, a long line across it and a few short ones, in pixels of a frame of ``size``."""
    across = np.stack([np.linspace(0.27, 0.73, 60), 0.5 + 0.03 * np.sin(np.linspace(0, 9, 60))], axis=1)
    strokes = [rim(size), Stroke.even(size * across, 1.0)]
    for x, y in ((0.4, 0.4), (0.6, 0.4), (0.5, 0.6)):
        strokes.append(Stroke.even(size * np.array([[x, y], [x + 0.02, y], [x + 0.03, y + 0.02]]), 0.75))
    return strokes


def angles(one: Maps, two: Maps) -> Doubles:
    """Return the degrees between normals where both maps have the object."""
    both = one.mask & two.mask
    return mesh_shapes.angles(one.normal[both], two.normal[both])
