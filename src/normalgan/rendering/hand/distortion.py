"""Distortion: a smooth deformation of a whole drawing together with its maps."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.rendering.maps import Maps

_CELLS = 4
"""Number of spline cells along a side of the frame; displacements vary over about half a side."""
_OUTER_CELLS = 1  # number of cells around the frame, beyond which the displacement is constant
KNOTS = _CELLS + 2 * _OUTER_CELLS + 3
"""Number of spline coefficients along each axis."""
_SPREAD = 0.479  # root mean square of a 2D cubic B-spline with standard normal coefficients
_STEEPEST = 0.45  # maximum slope of the displacement relative to the matrix; below 1, nothing folds over
_NEWTON_STEPS = 12  # Newton iterations; fewer than four are enough if nothing folds over
_CONVERGED = 1e-4  # fraction of the side; below this, another Newton iteration leaves less than 1e-7


@dataclass(frozen=True)
class Distortion:
    """A deformation given by source positions, in fractions of the frame's side, x right and y down.

    Point q of the distorted drawing comes from ``c + matrix (r - c) + u(r)``, where c is the frame's
    centre, u is a uniform cubic B-spline, and ``r = (q - shift) / zoom``.

    Args:
        matrix: (2, 2) matrix of the affine part.
        bends: (2, `KNOTS`, `KNOTS`) coefficients of the x and y components of u, by row and column.
        zoom: final scale factor of the drawing, which scales the object in all three directions.
        shift: (2,) translation after the scaling.
    """

    matrix: Doubles
    bends: Doubles
    zoom: float
    shift: Doubles

    def sources(self, points: Doubles) -> tuple[Doubles, Doubles]:
        """Return the source positions of points (N, 2) of the distorted drawing, and Jacobians (N, 2, 2)."""
        r = (points - self.shift) / self.zoom
        (bx, sx), (by, sy) = _spline(r[:, 0]), _spline(r[:, 1])
        source = 0.5 + (r - 0.5) @ self.matrix.T
        jacobian = np.empty((len(points), 2, 2))
        for k, part in enumerate(self.bends):
            across = by @ part
            source[:, k] += (across * bx).sum(axis=1)
            jacobian[:, k, 0] = (across * sx).sum(axis=1)
            jacobian[:, k, 1] = ((sy @ part) * bx).sum(axis=1)
        return source, (jacobian + self.matrix) / self.zoom

    def move(self, points: Doubles) -> Doubles:
        """Return the distorted positions of points (N, 2), inverting `sources` by Newton's method."""
        moved = (0.5 + (points - 0.5) @ np.linalg.inv(self.matrix).T) * self.zoom + self.shift
        for _ in range(_NEWTON_STEPS):
            source, jacobian = self.sources(moved)
            missing = points - source
            (a, b), (c, d) = jacobian.transpose(1, 2, 0)
            x, y = missing.T / (a * d - b * c)
            moved = moved + np.stack([d * x - b * y, a * y - c * x], axis=1)
            if np.abs(missing).max(initial=0) < _CONVERGED:
                break
        return moved

    def grid(self, height: int, width: int) -> tuple[Doubles, Doubles]:
        """Return `sources` of all pixel centres, x and y (2, H, W), and the Jacobian (2, 2, H, W).

        The Jacobian excludes the zoom, because the object itself is scaled, not only its picture.
        Fractions refer to the longer side.
        """
        side = max(height, width)
        x = ((np.arange(width) + 0.5) / side - self.shift[0]) / self.zoom
        y = ((np.arange(height) + 0.5) / side - self.shift[1]) / self.zoom
        (bx, sx), (by, sy) = _spline(x), _spline(y)
        matrix, half = self.matrix, np.float64(0.5)
        place = np.empty((2, height, width))
        jacobian = np.empty((2, 2, height, width))
        for k, part in enumerate(self.bends):  # the spline is separable into rows and columns
            place[k] = (
                half + matrix[k, 0] * (x - half) + matrix[k, 1] * (y[:, None] - half) + by @ part @ bx.T
            )
            jacobian[k, 0] = matrix[k, 0] + by @ part @ sx.T
            jacobian[k, 1] = matrix[k, 1] + sy @ part @ bx.T
        return place, jacobian


def _spline(at: Doubles) -> tuple[Doubles, Doubles]:
    """Return the matrices (N, `KNOTS`) from coefficients to values and derivatives at (N,) positions."""
    knot = at * _CELLS + _OUTER_CELLS
    held = knot.clip(0, _CELLS + 2 * _OUTER_CELLS)
    off = held[:, None] + 1 - np.arange(KNOTS)  # distance in cells from the centre of each cubic B-spline
    two, one = np.maximum(2 - np.abs(off), 0), np.maximum(1 - np.abs(off), 0)
    inside = _CELLS * (held == knot)[:, None]
    return two * two * two / 6 - one * one * one / 1.5, (2 * one * one - two * two / 2) * np.sign(
        off
    ) * inside


def random_distortion(bend: float, proportion: float, maps: Maps, rng: np.random.Generator) -> Distortion:
    """Return a random distortion that keeps the object's position and size in the frame.

    Args:
        bend: standard deviation of the displacement along each axis, as a fraction of the side.
        proportion: standard deviation of the logarithm of the aspect ratio and of the shear; half of it is
            the standard deviation of the rotation in radians.
        maps: maps of the object.
        rng: source of randomness.
    """
    ratio, shear, turn = np.clip(rng.standard_normal(3), -2.5, 2.5) * proportion
    cos, sin, stretch = np.cos(turn / 2), np.sin(turn / 2), np.exp(ratio / 2)
    matrix = np.array([[cos, -sin], [sin, cos]]) @ np.array([[stretch, shear], [0, 1 / stretch]])
    bends = bend / _SPREAD * rng.standard_normal((2, KNOTS, KNOTS))
    plain = Distortion(matrix, bends, 1.0, np.zeros(2))
    slope = plain.grid(48, 48)[1] - matrix[:, :, None, None]
    steepest = float(np.sqrt((slope * slope).sum(axis=(0, 1)).max()))
    least = float(np.linalg.svd(matrix, compute_uv=False)[-1])
    bends = bends * min(1.0, _STEEPEST * least / max(steepest, 1e-12))
    return _framed(Distortion(matrix, bends, 1.0, np.zeros(2)), maps)


def _framed(distortion: Distortion, maps: Maps) -> Distortion:
    """Return the distortion with the zoom and shift that preserve the object's centre and longer side."""
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    inner = cv2.erode(maps.mask.astype(np.uint8), cross, borderValue=0) > 0
    rows, columns = np.nonzero(maps.mask & ~inner)
    if not len(rows):
        return distortion
    before = (np.stack([columns, rows], axis=1) + 0.5) / max(maps.mask.shape)
    every = 1 + len(rows) // 300  # a few hundred points are enough for the extent
    after = distortion.move(before[(rows % every == 0) | (columns % every == 0)])
    (low, high), (left, right) = ((p.min(axis=0), p.max(axis=0)) for p in (before, after))
    zoom = float((high - low).max() / max(float((right - left).max()), 1e-9))
    return Distortion(distortion.matrix, distortion.bends, zoom, (low + high - zoom * (left + right)) / 2)


_SAME_SURFACE = 0.5  # neighbours with a larger difference in a normal component belong to different surfaces


def follow(maps: Maps, distortion: Distortion) -> Maps:
    """Return the maps of an object after distorting its picture; depth values do not change.

    If point p of the picture moves to q, then q has the height z(p). With J = dp/dq, its gradient is J^T
    dz/dp. Therefore (nx, ny) becomes J^T (nx, ny), nz is unchanged, and the vector is normalised. Only
    those of the four neighbouring pixels that lie on the same surface as the nearest one are interpolated,
    so that neither the background nor a more distant part blends in. The depth is that of the nearest pixel.
    """
    place, jacobian = distortion.grid(*maps.mask.shape)
    x, y = (place * max(maps.mask.shape) - 0.5).astype(np.float32)  # pixel centres at integers
    mask = cv2.remap(maps.mask.astype(np.float32), x, y, cv2.INTER_LINEAR, borderValue=0) > 0.5
    at = np.flatnonzero(mask)
    normal, depth = _sample(maps, x, y, at)
    (xx, xy), (yx, yy) = jacobian.reshape(2, 2, -1)[:, :, at].astype(np.float32)
    nx, ny, nz = normal.T
    nx, ny = xx * nx - yx * ny, yy * ny - xy * nx  # y points down in J and up in normals
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    normals, depths = np.zeros_like(maps.normal), np.full_like(maps.depth, np.inf)
    normals.reshape(-1, 3)[at] = np.stack([nx / length, ny / length, nz / length], axis=1)
    depths.reshape(-1)[at] = depth
    return Maps(normals, depths, mask)


def _sample(maps: Maps, x: Floats, y: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Return unnormalised normals (N, 3) and depths (N,) of the object.

    The maps are sampled at the pixel positions ``x`` and ``y`` (H, W) for the flat indices ``at``.
    """
    height, width = maps.mask.shape
    normal: Floats = cv2.remap(maps.normal, x, y, cv2.INTER_LINEAR).reshape(-1, 3)[at].astype(np.float32)
    x, y = x.reshape(-1)[at], y.reshape(-1)[at]
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    inside = (left >= 0) & (top >= 0) & (left < width - 1) & (top < height - 1)
    index = (top * width + left).clip(0, height * width - 1)
    mixed = np.flatnonzero(~(inside & _one_surface(maps).reshape(-1)[index]))
    depth = maps.depth.reshape(-1)[index + (x - left > 0.5) + width * (y - top > 0.5)]
    normal[mixed], depth[mixed] = _sort_out(maps, x[mixed], y[mixed], left[mixed], top[mixed])
    return normal, depth


def _one_surface(maps: Maps) -> BoolMask:
    """Return where a pixel and its right, lower and lower right neighbours are on one surface, (H, W)."""
    square, corner = np.ones((2, 2), np.uint8), (0, 0)
    spread = cv2.dilate(maps.normal, square, anchor=corner) - cv2.erode(maps.normal, square, anchor=corner)
    alike = cv2.inRange(spread, (-1.0,) * 3, (_SAME_SURFACE,) * 3)
    whole = cv2.erode(maps.mask.astype(np.uint8), square, anchor=corner)
    return (alike > 0) & (whole > 0)


def _sort_out(maps: Maps, x: Floats, y: Floats, left: Indices, top: Indices) -> tuple[Floats, Floats]:
    """Sample like `_sample` at positions where the four pixels belong to different surfaces."""
    height, width = maps.mask.shape
    normals, depths = maps.normal.reshape(-1, 3), maps.depth.reshape(-1)
    corners, weights = [], []
    for j in (0, 1):
        for i in (0, 1):
            index = (top + j).clip(0, height - 1) * width + (left + i).clip(0, width - 1)
            corners.append(index)
            weights.append(np.abs(1 - i - x + left) * np.abs(1 - j - y + top) * maps.mask.reshape(-1)[index])
    weight = np.stack(weights)
    nearest = np.take_along_axis(np.stack(corners), weight.argmax(axis=0)[None], axis=0)[0]
    own = normals[nearest]
    total = np.zeros_like(own)
    for index, fraction in zip(corners, weight, strict=True):
        normal = normals[index]
        total += (fraction * (np.abs(normal - own) <= _SAME_SURFACE).all(axis=1))[:, None] * normal
    return total, depths[nearest]
