"""Apparent ridges and valleys: folds that no contour shows."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles, Floats
from normalgan.ranges import NonNegative, Positive, PositiveInt, check_ranges
from normalgan.rendering.lines.apparent_ridges import apparent_curvature, extremes
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.inside import Inside
from normalgan.rendering.lines.outlined import OutlinedDrawing
from normalgan.rendering.lines.projection import towards_eye
from normalgan.rendering.lines.shapes import Shape, shape_of
from normalgan.rendering.lines.surface_lines import EdgeMarks
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["RidgesAndValleys", "apparent_ridges"]

_FACING = 0.15  # below this n·v a ridge counts as a contour


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class RidgesAndValleys(OutlinedDrawing):
    """Occluding contours, and the ridges and valleys between them.

    Ridges and valleys here are apparent ones (Judd, Durand, Adelson, "Apparent Ridges for Line Drawing",
    SIGGRAPH 2007): where the normal turns fastest per length in the picture. The extremes of curvature
    itself (Ohtake, Belyaev, Seidel, "Ridge-Valley Lines on Meshes via Implicit Surface Fitting", SIGGRAPH
    2004) were tried and left: they do not depend on the view, and run in streaks along limbs and tails.

    Args:
        line_width: width of contours in pixels of the sketch, at any sketch size.
        interior_width: width of the ridges and valleys in pixels of the sketch; 0 draws none.
        gap: how far the surface must jump back for a contour, beyond what its slope explains, as a
            fraction of the frame's side.
        smoothing: standard deviation of the smoothing of the curvature, as a fraction of the object's
            radius.
        strength: how sharply the surface must turn for a ridge or valley, in radians over the object's
            radius as it is seen; a line that has begun continues down to a third of it.
        sharpness: by how much more than beside it, in units of the curvature cubed; a limb is round, so its
            middle is not a ridge.
        shortest_contour: contours that span less than this fraction of the frame's side are left out.
        shortest: ridges and valleys shorter than this fraction of the frame's side are left out.
        bridge: gaps up to this fraction of the frame's side do not break one.
        apart: one that keeps nearer than this to a contour, on average, as a fraction of the frame's side,
            is left out: it would only double the contour.
        resolution: side in pixels of the maps in which contours and hidden strokes are found.

    Raises:
        InputError: if a setting is out of range.
    """

    line_width: Positive = 1.25
    interior_width: NonNegative = 0.9
    gap: Positive = 0.01
    smoothing: NonNegative = 0.03
    strength: Positive = 6.0
    sharpness: NonNegative = 0.2
    shortest_contour: NonNegative = 0.012
    shortest: NonNegative = 0.05
    bridge: NonNegative = 0.02
    apart: NonNegative = 0.015
    resolution: PositiveInt = 512

    def __post_init__(self) -> None:
        check_ranges(self)

    def _draw_inside(self, view: View, buffers: Buffers, distance: Floats) -> list[Stroke]:
        """Return the ridges and valleys; see `OutlinedDrawing._draw_inside`."""
        shape = shape_of(view.mesh, self.smoothing)
        eye = towards_eye(view.camera, shape.surface.vertices)
        pen = Inside(
            self.interior_width, self.strength, self.shortest, self.bridge, self.apart, smoothing=0.02
        )
        return [
            stroke
            for marks, strength in apparent_ridges(shape, eye, self.sharpness)
            for stroke in pen.draw(shape.surface, view, buffers, distance, marks, strength)
        ]


def apparent_ridges(shape: Shape, eye: Doubles, sharpness: float) -> list[tuple[EdgeMarks, Doubles]]:
    """Return the ridges, then the valleys: where they cross edges, and their view-dependent curvature.

    Where a ridge is blunter than ``sharpness`` its strength is 0, so that the gap can be bridged.

    Args:
        shape: the mesh and its curvature.
        eye: (V, 3) unit vectors to the eye.
        sharpness: see `RidgesAndValleys`.
    """
    curvature, along = apparent_curvature(shape, eye)
    marks, peaked = extremes(shape.surface, curvature, along)
    facing = np.einsum("vc,vc->v", shape.normals, eye)
    bulge = np.einsum("va,vab,vb->v", along, shape.operators, along)
    here, bulging = marks.take(shape.surface, curvature), marks.take(shape.surface, bulge) > 0
    strength = np.where(peaked > sharpness * here**3, here, 0)
    towards = marks.take(shape.surface, facing) > _FACING
    return [(marks.only(kept), strength[kept]) for kept in (towards & bulging, towards & ~bulging)]
