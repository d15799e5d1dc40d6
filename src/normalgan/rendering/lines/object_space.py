"""Suggestive contours found on the mesh; finer than in the picture, so that eyes and nostrils survive."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.arrays import Doubles
from normalgan.ranges import Positive, Range
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.surface import Shape
from normalgan.rendering.lines.surface_lines import EdgeMarks, SurfaceDrawing, zero_marks

__all__ = ["ObjectSpaceSuggestive", "radial_curvature"]


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class ObjectSpaceSuggestive(SurfaceDrawing):
    """Occluding contours, and suggestive contours found on the mesh instead of in the picture.

    They are where the radial curvature, the curvature along the direction of the eye, changes from
    hollow to bulging as one comes nearer (DeCarlo, Finkelstein, Rusinkiewicz, Santella, "Suggestive
    Contours for Conveying Shape", SIGGRAPH 2003, section 3): lines that follow the mesh at any sketch size
    and thin out where they fade.

    Args:
        strength: how fast the radial curvature must change for a stroke, of an object of radius 1; a stroke
            that has begun continues down to a third of it.
        theta: degrees between normal and view vector below which no stroke is drawn.

    Raises:
        InputError: if a setting is out of range.
    """

    strength: Positive = 35.0
    theta: Annotated[float, Range(0, 90, below=True)] = 15.0

    def _find(self, shape: Shape, eye: Doubles) -> list[tuple[EdgeMarks, Doubles]]:
        """Return the suggestive contours; see `SurfaceDrawing._find`."""
        facing, radial, rise = radial_curvature(shape, eye)
        turned = (facing > 0) & (facing < np.cos(np.deg2rad(self.theta)))
        marks = zero_marks(shape.surface, radial, turned)
        return [(marks, marks.take(shape.surface, rise))]


def radial_curvature(shape: Shape, eye: Doubles) -> tuple[Doubles, Doubles, Doubles]:
    """Return n·v, the radial curvature times sin², and its rise towards the eye, (V,) each.

    The radial curvature is that along w, the projection of the view vector v to the tangent plane; with
    ``S n = 0`` it is ``v · S v / (w · w)``, positive where the surface bulges. Its rise is its derivative
    along w / |w|; at a zero of the radial curvature, the derivative of ``v · S v`` can replace it. ``eye``
    are the view vectors (V, 3), of unit length.
    """
    normals = shape.normals
    facing = np.einsum("vc,vc->v", normals, eye)
    along = eye - facing[:, None] * normals
    sine = np.maximum(np.linalg.norm(along, axis=1), 1e-6)
    radial = np.einsum("va,vab,vb->v", eye, shape.operators, eye)
    rise = np.einsum("vc,vc->v", shape.surface.slope(radial), along) / sine**3
    return facing, radial, rise
