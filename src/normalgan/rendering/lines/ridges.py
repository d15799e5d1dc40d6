"""Apparent ridges and valleys: folds that no contour shows."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles
from normalgan.ranges import NonNegative, Positive
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.surface import Shape, Surface
from normalgan.rendering.lines.surface_lines import EdgeMarks, SurfaceDrawing

__all__ = ["RidgesAndValleys", "apparent_curvature", "extremes"]

_FACING = 0.15  # below this n·v a ridge counts as a contour
_GRAZING = 0.1  # the least n·v; below it foreshortening would have no bound


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class RidgesAndValleys(SurfaceDrawing):
    """Occluding contours, and the ridges and valleys between them.

    Ridges and valleys here are apparent ones (Judd, Durand, Adelson, "Apparent Ridges for Line Drawing",
    SIGGRAPH 2007): where the normal turns fastest per length in the picture. The extremes of curvature
    itself (Ohtake, Belyaev, Seidel, "Ridge-Valley Lines on Meshes via Implicit Surface Fitting", SIGGRAPH
    2004) were tried and left: they do not depend on the view, and run in streaks along limbs and tails.

    Args:
        strength: how sharply the surface must turn for a ridge or valley, in radians over the object's
            radius as it is seen; a line that has begun continues down to a third of it.
        sharpness: by how much more than beside it, in units of the curvature cubed; a limb is round, so its
            middle is not a ridge.

    Raises:
        InputError: if a setting is out of range.
    """

    smoothing: NonNegative = 0.03
    strength: Positive = 6.0
    sharpness: NonNegative = 0.2
    shortest: NonNegative = 0.05
    apart: NonNegative = 0.015

    _rounding = 0.02

    def _find(self, shape: Shape, eye: Doubles) -> list[tuple[EdgeMarks, Doubles]]:
        """Return the ridges, then the valleys; see `SurfaceDrawing._find`.

        Where a ridge is too blunt its strength is 0, so that the gap can be bridged.
        """
        curvature, along = apparent_curvature(shape, eye)
        marks, peaked = extremes(shape.surface, curvature, along)
        facing = np.einsum("vc,vc->v", shape.normals, eye)
        bulge = np.einsum("va,vab,vb->v", along, shape.operators, along)
        here, bulging = marks.take(shape.surface, curvature), marks.take(shape.surface, bulge) > 0
        strength = np.where(peaked > self.sharpness * here**3, here, 0)
        towards = marks.take(shape.surface, facing) > _FACING
        return [(marks.only(kept), strength[kept]) for kept in (towards & bulging, towards & ~bulging)]


def apparent_curvature(shape: Shape, eye: Doubles) -> tuple[Doubles, Doubles]:
    """Return the largest turn of the normal per length in the picture, (V,), and its direction, (V, 3).

    With a and b the tangents towards and across the eye's direction, a step along a is shortened by n·v in
    the picture and one along b is not. The view-dependent curvature is the largest singular value of the
    shape operator after undoing that; the direction returned is the tangent whose picture is its right
    singular vector (Judd, Durand, Adelson, "Apparent Ridges for Line Drawing", SIGGRAPH 2007, section 4).
    ``eye`` are the unit vectors (V, 3) to the eye.
    """
    normals, operators = shape.normals, shape.operators
    facing = np.einsum("vc,vc->v", normals, eye)
    towards = eye - facing[:, None] * normals
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    across = np.cross(normals, towards)
    lengthened = towards / np.maximum(facing, _GRAZING)[:, None]
    steps = np.stack([lengthened, across], axis=2)  # (V, 3, 2): one pixel along each, on the surface
    turns = operators @ steps
    # The right singular vector of a matrix of two columns is the longer axis of its Gram matrix.
    gram = turns.transpose(0, 2, 1) @ turns
    xx, yy, xy = gram[:, 0, 0], gram[:, 1, 1], gram[:, 0, 1]
    angle = np.arctan2(2 * xy, xx - yy) / 2
    largest = (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)
    along = np.einsum("vck,kv->vc", steps, np.stack([np.cos(angle), np.sin(angle)]))
    return np.sqrt(largest), along


def extremes(surface: Surface, values: Doubles, along: Doubles) -> tuple[EdgeMarks, Doubles]:
    """Return where values (V,) are largest or smallest along tangents (V, 3), and how peaked they are there.

    The marks are zeros of the derivative. The tangents' lengths count. They have no sign: along an edge, that
    of its first vertex counts. The peakedness is minus the second derivative, (N,), positive at a maximum.
    """
    rise = np.einsum("vc,vc->v", surface.slope(values), along)
    one, other = surface.edges.T
    sign = np.where(np.einsum("vc,vc->v", along[one], along[other]) < 0, -1.0, 1.0)
    step = surface.vertices[other] - surface.vertices[one]
    norm = np.maximum(np.linalg.norm(along, axis=1), 1e-12)
    unit = along / norm[:, None]
    # Least squares over the edges of a vertex: the change of the derivative along its direction.
    ahead, behind = (step * unit[one]).sum(1), -(step * unit[other]).sum(1)
    count = len(values)
    change = np.bincount(one, (sign * rise[other] - rise[one]) * ahead, count)
    change += np.bincount(other, (sign * rise[one] - rise[other]) * behind, count)
    spread = np.bincount(one, ahead**2, count) + np.bincount(other, behind**2, count)
    peaked = -change * norm / np.maximum(spread, 1e-12)
    before, after = rise[one], sign * rise[other]
    crossed = np.flatnonzero((before < 0) != (after < 0))
    before, after = before[crossed], after[crossed]
    marks = EdgeMarks(crossed, before / (before - after))
    return marks, marks.take(surface, peaked)
