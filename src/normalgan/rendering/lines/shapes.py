"""Shapes: the surface and the curvature of the mesh drawn last, which views of one mesh share."""

from dataclasses import dataclass

from normalgan.rendering.lines.surface import Surface
from normalgan.rendering.lines.surface_curvature import shape_operators, smooth_normals
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.strokes.stroke import Doubles

# Views of one mesh follow one another, so one is enough, and memory stays flat. It belongs to the process.
_last: tuple[Mesh, float, "Shape"] | None = None


@dataclass(frozen=True)
class Shape:
    """What a mesh is like at every vertex.

    Args:
        surface: the mesh.
        normals: (V, 3) unit vectors, smoothed.
        operators: (V, 3, 3) see `shape_operators`.
    """

    surface: Surface
    normals: Doubles
    operators: Doubles


def shape_of(mesh: Mesh, smoothing: float) -> Shape:
    """Return the shape of a mesh, its curvature smoothed over ``smoothing`` units of the mesh."""
    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] is not mesh or _last[1] != smoothing:
        surface = Surface.of(mesh)
        normals = smooth_normals(surface, smoothing)
        operators = shape_operators(surface, normals, smoothing)
        _last = (mesh, smoothing, Shape(surface, normals, operators))
    return _last[2]
