"""Suggestive contours found on the mesh; finer than in the picture, so that eyes and nostrils survive."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.arrays import Doubles, Floats
from normalgan.ranges import NonNegative, Positive, PositiveInt, Range, check_ranges
from normalgan.rendering.cameras import towards_eye
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.contours import OutlinedDrawing
from normalgan.rendering.lines.surface import Shape, shape_of
from normalgan.rendering.lines.surface_lines import Inside, zero_marks
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["ObjectSpaceSuggestive", "radial_curvature"]


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class ObjectSpaceSuggestive(OutlinedDrawing):
    """Occluding contours, and suggestive contours found on the mesh instead of in the picture.

    They are where the radial curvature, the curvature along the direction of the eye, changes from
    hollow to bulging as one comes nearer (DeCarlo, Finkelstein, Rusinkiewicz, Santella, "Suggestive
    Contours for Conveying Shape", SIGGRAPH 2003, section 3): lines that follow the mesh at any sketch size
    and thin out where they fade.

    Args:
        line_width: width of contours in pixels of the sketch, at any sketch size.
        interior_width: width of the strokes inside in pixels of the sketch; 0 draws none.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side.
        smoothing: standard deviation of the smoothing of the curvature, as a fraction of the object's
            radius.
        strength: how fast the radial curvature must change for a stroke, of an object of radius 1; a stroke
            that has begun continues down to a third of it.
        theta: degrees between normal and view vector below which no stroke is drawn.
        shortest_contour: contours that span less than this fraction of the frame's side are left out.
        shortest: strokes inside that are shorter than this fraction of the frame's side are left out.
        bridge: gaps up to this fraction of the frame's side do not break a stroke.
        apart: a stroke that keeps nearer than this to a contour, on average, as a fraction of the
            frame's side, is left out: it would only double the contour.
        resolution: side in pixels of the maps in which contours and hidden strokes are found.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: Positive = 1.25
    interior_width: NonNegative = 0.9
    gap: Positive = 0.01
    smoothing: NonNegative = 0.015
    strength: Positive = 35.0
    theta: Annotated[float, Range(0, 90, below=True)] = 15.0
    shortest_contour: NonNegative = 0.012
    shortest: NonNegative = 0.045
    bridge: NonNegative = 0.02
    apart: NonNegative = 0.012
    resolution: PositiveInt = 512

    def __post_init__(self) -> None:
        check_ranges(self)

    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the suggestive contours; see `OutlinedDrawing._draw_inside`."""
        shape = shape_of(view.mesh, self.smoothing)
        facing, radial, rise = radial_curvature(shape, towards_eye(view.camera, shape.surface.vertices))
        turned = (facing > 0) & (facing < np.cos(np.deg2rad(self.theta)))
        marks = zero_marks(shape.surface, radial, turned)
        pen = Inside(self.interior_width, self.strength, self.shortest, self.bridge, self.apart)
        return pen.draw(shape.surface, view, buffers, distance, marks, marks.take(shape.surface, rise))


def radial_curvature(shape: Shape, eye: Doubles) -> tuple[Doubles, Doubles, Doubles]:
    """Return n·v, the radial curvature times sin², and its rise towards the eye, (V,) each.

    The radial curvature is that along w, the projection of the view vector v to the tangent plane; with
    ``S n = 0`` it is ``v · S v / (w · w)``, positive where the surface bulges. Its rise is its derivative
    along w / |w|; at a zero of the radial curvature, the derivative of ``v · S v`` can replace it.

    Args:
        shape: the mesh and its curvature.
        eye: (V, 3) unit vectors to the eye.
    """
    normals = shape.normals
    facing = np.einsum("vc,vc->v", normals, eye)
    along = eye - facing[:, None] * normals
    sine = np.maximum(np.linalg.norm(along, axis=1), 1e-6)
    radial = np.einsum("va,vab,vb->v", eye, shape.operators, eye)
    rise = np.einsum("vc,vc->v", shape.surface.slope(radial), along) / sine**3
    return facing, radial, rise
