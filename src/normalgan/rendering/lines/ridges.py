"""Apparent ridges and valleys: folds that are not contours."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles
from normalgan.ranges import NonNegative, Positive
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.surface import MeshSurface, SurfaceShape
from normalgan.rendering.lines.surface_lines import EdgeMarks, SurfaceDrawing

_FACING = 0.15  # n·v below which a ridge counts as a contour
_GRAZING = 0.1  # minimum n·v, because foreshortening has no bound


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class RidgesAndValleys(SurfaceDrawing):
    """Occluding contours, and the ridges and valleys between them.

    These are apparent ridges and valleys (Judd, Durand, Adelson, "Apparent Ridges for Line Drawing",
    SIGGRAPH 2007), where the normal changes fastest per length in the picture. The extrema of the
    curvature itself (Ohtake, Belyaev, Seidel, "Ridge-Valley Lines on Meshes via Implicit Surface Fitting",
    SIGGRAPH 2004) were tried and rejected. They do not depend on the view, and form streaks along limbs
    and tails.

    Args:
        strength: minimum view-dependent curvature of a ridge or valley, in radians per radius of the
            object in the picture. A line continues as long as it reaches a third of this.
        sharpness: minimum peakedness of a ridge or valley, the negative second derivative of the curvature
            across it, in units of the curvature cubed. A limb is round, so its middle is not a ridge.
    """

    smoothing: NonNegative = 0.03
    strength: Positive = 6.0
    sharpness: NonNegative = 0.2
    shortest: NonNegative = 0.05
    apart: NonNegative = 0.015

    _rounding = 0.02

    def _find(self, shape: SurfaceShape, eye: Doubles) -> list[tuple[EdgeMarks, Doubles]]:
        """Return the ridges, then the valleys; see `SurfaceDrawing._find`.

        Where a ridge is too blunt, its strength is 0, so that the gap can be bridged.
        """
        curvature, along = apparent_curvature(shape, eye)
        marks, peaked = extremes(shape.surface, curvature, along)
        facing = np.einsum("vc,vc->v", shape.normals, eye)
        bulge = np.einsum("va,vab,vb->v", along, shape.operators, along)
        here, bulging = marks.take(shape.surface, curvature), marks.take(shape.surface, bulge) > 0
        strength = np.where(peaked > self.sharpness * here**3, here, 0)
        towards = marks.take(shape.surface, facing) > _FACING
        return [(marks.only(kept), strength[kept]) for kept in (towards & bulging, towards & ~bulging)]


def apparent_curvature(shape: SurfaceShape, eye: Doubles) -> tuple[Doubles, Doubles]:
    """Return the maximum change of the normal per length in the picture, (V,), and its direction, (V, 3).

    Let a and b be the tangents along and across the viewing direction. In the picture, a step along a is
    shortened by n·v, and a step along b is not. The view-dependent curvature is the largest singular value
    of the shape operator after correcting for this. The returned direction is the tangent that projects to
    the right singular vector (Judd, Durand, Adelson, "Apparent Ridges for Line Drawing", SIGGRAPH 2007,
    section 4). ``eye`` holds the unit vectors (V, 3) to the viewer.
    """
    normals, operators = shape.normals, shape.operators
    facing = np.einsum("vc,vc->v", normals, eye)
    towards = eye - facing[:, None] * normals
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    across = np.cross(normals, towards)
    lengthened = towards / np.maximum(facing, _GRAZING)[:, None]
    steps = np.stack([lengthened, across], axis=2)  # (V, 3, 2): steps of one pixel
    turns = operators @ steps
    # The right singular vector of a matrix with two columns is the major axis of its Gram matrix.
    gram = turns.transpose(0, 2, 1) @ turns
    xx, yy, xy = gram[:, 0, 0], gram[:, 1, 1], gram[:, 0, 1]
    angle = np.arctan2(2 * xy, xx - yy) / 2
    largest = (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)
    along = np.einsum("vck,kv->vc", steps, np.stack([np.cos(angle), np.sin(angle)]))
    return np.sqrt(largest), along


def extremes(surface: MeshSurface, values: Doubles, along: Doubles) -> tuple[EdgeMarks, Doubles]:
    """Return the extrema of values (V,) along tangents (V, 3), and the negative second derivatives there.

    The extrema are zeros of the derivative along the tangents, scaled by their lengths. Tangents have no
    sign, so along an edge, the sign of the first vertex is used. The negative second derivative, (N,), is
    positive at a maximum.
    """
    rise = np.einsum("vc,vc->v", surface.slope(values), along)
    one, other = surface.edges.T
    sign = np.where(np.einsum("vc,vc->v", along[one], along[other]) < 0, -1.0, 1.0)
    step = surface.vertices[other] - surface.vertices[one]
    norm = np.maximum(np.linalg.norm(along, axis=1), 1e-12)
    unit = along / norm[:, None]
    # Least squares fit, over the edges of a vertex, of the derivative's change along its direction.
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
