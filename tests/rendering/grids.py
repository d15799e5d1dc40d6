"""Height fields as meshes, seen straight from above: what lies where in the sketch is known exactly."""

from collections.abc import Callable

import numpy as np
from mesh_shapes import as_mesh

from normalgan.arrays import Doubles
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.view import View


def height_field(height: Callable[[Doubles, Doubles], Doubles], points: int = 72, half: float = 0.7) -> Mesh:
    """Return the mesh of z = height(x, y) over a square, by ``points`` a side, of random diagonals."""
    grid = np.linspace(-half, half, points)
    x, y = (part.ravel() for part in np.meshgrid(grid, grid))
    corner = (np.arange(points - 1)[:, None] * points + np.arange(points - 1)).ravel()
    right, up, both = corner + 1, corner + points, corner + points + 1
    rising = np.random.default_rng(0).random(len(corner)) < 0.5
    first = np.where(rising, [corner, right, both], [corner, right, up]).T
    second = np.where(rising, [corner, both, up], [right, both, up]).T
    return as_mesh("field", np.stack([x, y, height(x, y)], axis=1), np.concatenate([first, second]))


def from_above(mesh: Mesh, size: int = 128) -> View:
    """Return a view along -z: the square of `height_field` fills the frame but for a margin of 6 %."""
    return View(mesh, framed(mesh.vertices, look_at_origin(0, 0, 0), None, 0.06), EmbreeRenderer(), size)


def to_plane(points: Doubles, size: int = 128, half: float = 0.7) -> Doubles:
    """Return points (P, 2) of the sketch in the x and y of the height field."""
    centred: Doubles = (points / size - 0.5) * [1, -1] * 2 * half / 0.88
    return centred
