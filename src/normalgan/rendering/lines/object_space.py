"""Suggestive contours found on the mesh, which preserve finer detail such as eyes and nostrils."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.arrays import Doubles
from normalgan.ranges import Positive, Range
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.surface import SurfaceShape
from normalgan.rendering.lines.surface_lines import EdgeMarks, SurfaceDrawing, zero_marks


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class ObjectSpaceSuggestive(SurfaceDrawing):
    """Occluding contours, and suggestive contours found on the mesh instead of in the picture.

    Suggestive contours are where the radial curvature, the curvature in the viewing direction, changes
    from concave to convex towards the viewer (DeCarlo, Finkelstein, Rusinkiewicz, Santella, "Suggestive
    Contours for Conveying Shape", SIGGRAPH 2003, section 3). The lines follow the mesh at any sketch size
    and get thinner where they fade.

    Args:
        strength: minimum rate of change of the radial curvature at a stroke, for an object of radius 1. A
            stroke continues as long as it reaches a third of this.
        theta: minimum angle in degrees between normal and view vector at a stroke.
    """

    strength: Positive = 35.0
    theta: Annotated[float, Range(0, 90, below=True)] = 15.0

    def _find(self, shape: SurfaceShape, eye: Doubles) -> list[tuple[EdgeMarks, Doubles]]:
        """Return the suggestive contours; see `SurfaceDrawing._find`."""
        facing, radial, rise = radial_curvature(shape, eye)
        turned = (facing > 0) & (facing < np.cos(np.deg2rad(self.theta)))
        marks = zero_marks(shape.surface, radial, turned)
        return [(marks, marks.take(shape.surface, rise))]


def radial_curvature(shape: SurfaceShape, eye: Doubles) -> tuple[Doubles, Doubles, Doubles]:
    """Return n·v, the radial curvature times sin², and its increase towards the viewer, (V,) each.

    The radial curvature is the curvature along w, the projection of the view vector v onto the tangent
    plane. With ``S n = 0``, it is ``v · S v / (w · w)``, which is positive where the surface is convex.
    Its increase is the derivative along w / |w|, which at a zero of the radial curvature can be replaced
    by the derivative of ``v · S v``. ``eye`` holds the view vectors (V, 3) of unit length.
    """
    normals = shape.normals
    facing = np.einsum("vc,vc->v", normals, eye)
    along = eye - facing[:, None] * normals
    sine = np.maximum(np.linalg.norm(along, axis=1), 1e-6)
    radial = np.einsum("va,vab,vb->v", eye, shape.operators, eye)
    rise = np.einsum("vc,vc->v", shape.surface.slope(radial), along) / sine**3
    return facing, radial, rise
