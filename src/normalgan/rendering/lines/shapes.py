"""Shapes: surface and curvature of the last mesh, shared by its views."""

from dataclasses import dataclass

from normalgan.arrays import Doubles
from normalgan.rendering.lines.surface import Surface
from normalgan.rendering.lines.surface_curvature import shape_operators, smooth_normals
from normalgan.rendering.mesh import Mesh

__all__ = ["Shape", "shape_of"]


@dataclass(frozen=True)
class Shape:
    """Normals and curvature of a mesh at its vertices.

    Args:
        surface: the mesh.
        normals: (V, 3) unit vectors, smoothed.
        operators: (V, 3, 3) see `shape_operators`.
    """

    surface: Surface
    normals: Doubles
    operators: Doubles


# Views of a mesh are rendered in a row, so one mesh is kept, and memory stays flat. Its shapes are keyed by
# smoothing, which differs between the styles of a mixture. The cache belongs to the process.
_last: tuple[Mesh, Surface, dict[float, Shape]] | None = None


def shape_of(mesh: Mesh, smoothing: float) -> Shape:
    """Return the shape of a mesh, its curvature smoothed over ``smoothing`` units of the mesh."""
    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] is not mesh:
        _last = (mesh, Surface.of(mesh), {})
    _, surface, shapes = _last
    if smoothing not in shapes:
        normals = smooth_normals(surface, smoothing)
        shapes[smoothing] = Shape(surface, normals, shape_operators(surface, normals, smoothing))
    return shapes[smoothing]
