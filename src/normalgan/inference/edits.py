"""Edits of a predicted map: pins, tilted areas, brushes, carved lines and painted masks."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.conversion import reoriented
from normalgan.inference.regions import around
from normalgan.normals import normalize

REACH = 0.05
"""Default reach of a pin, as a fraction of the map's longer side."""
MOST_PINS = 200
"""Maximum number of pins; more hints are painted areas, which only the network uses."""
LEAST_REACH = 2.0
"""Minimum reach of a pin in pixels."""
AVERAGED = 0.25
"""Standard deviation of the smoothing brush's Gaussian, as a fraction of the brush's width."""
FADES = 0.5
"""Default width of the fade of an area without a form, as a fraction of the area's depth."""
BRUSH_FADES = 0.6
"""Default width of the fade of a brush stroke, as a fraction of its radius."""
SOFT = 0.01
"""Width of the soft edge of an area without a fade, as a fraction of the map's longer side."""


def enforce_pins(normals: Floats, points: Floats, wanted: Floats, reaches: Floats) -> Floats:
    """Return a map that has exactly the given normals at the pins and blends into the prediction around them.

    Each pin defines a rotation from the predicted normal to the given one. Radial basis functions interpolate
    the rotations exactly at all pins, even if two pins are close together and opposed.

    Args:
        normals: (H, W, 3), predicted unit normals.
        points: (K, 2), x and y of the pins in pixels.
        wanted: (K, 3), unit normals at the pins.
        reaches: (K,), radius of each pin's effect in pixels.

    References:
        Wendland 1995, "Piecewise polynomial, positive definite and compactly supported radial functions of
        minimal degree" (the C2 function for three dimensions).

    Example:
        >>> flat = np.zeros((40, 40, 3), np.float32)
        >>> flat[..., 2] = 1
        >>> points = np.array([[10.5, 20.5], [26.5, 20.5]], np.float32)
        >>> wanted = np.array([[-0.8, 0, 0.6], [0.8, 0, 0.6]], np.float32)
        >>> held = enforce_pins(flat, points, wanted, np.array([30.0, 30.0], np.float32))
        >>> bool(np.allclose(held[20, [10, 26]], wanted, atol=1e-3))
        True
    """
    height, width = normals.shape[:2]
    columns = np.clip(points[:, 0].astype(int), 0, width - 1)
    rows = np.clip(points[:, 1].astype(int), 0, height - 1)
    # If several pins lie in one pixel, the last one is used.
    _, kept = np.unique((rows * width + columns)[::-1], return_index=True)
    kept = len(rows) - 1 - kept
    rows, columns, wanted, reaches = rows[kept], columns[kept], wanted[kept], reaches[kept]
    reaches = np.maximum(reaches, LEAST_REACH)
    turns = _turns(normals[rows, columns], wanted)
    apart = np.hypot(columns[:, None] - columns[None], rows[:, None] - rows[None])
    basis = _wendland(apart / reaches[None]).astype(np.float64)
    shares = np.linalg.lstsq(basis, turns.astype(np.float64), rcond=None)[0]
    # Only the part of the map within reach of a pin is computed.
    whole = reaches.astype(int)
    top, left = max(int((rows - whole).min()), 0), max(int((columns - whole).min()), 0)
    reached = np.s_[top : int((rows + whole).max()) + 1, left : int((columns + whole).max()) + 1]
    field = np.zeros(normals[reached].shape, np.float32)
    for row, column, reach, share in zip(rows - top, columns - left, reaches, shares, strict=True):
        first, leftmost = max(row - int(reach), 0), max(column - int(reach), 0)
        box = np.s_[first : row + int(reach) + 1, leftmost : column + int(reach) + 1]
        y, x = np.ogrid[: field[box].shape[0], : field[box].shape[1]]
        away = np.hypot(x + leftmost - column, y + first - row) / reach
        field[box] += _wendland(away)[..., None] * share.astype(np.float32)
    touched = np.abs(field).sum(-1) > 1e-6
    held = normals.copy()
    held[reached] = _turned_where(touched, held[reached], field[touched])
    return held


def tilt(normals: Floats, mask: BoolMask, area: Floats, direction: Floats) -> Floats:
    """Return a map with an area rotated rigidly, so that its mean normal is a given direction.

    The area keeps its curvature: a flat wall stays flat, where a pin would make a dent.

    Args:
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.
        area: (H, W) in [0, 1], coverage of each pixel by the area.
        direction: (3,), unit vector.
    """
    inside = (area > 0.5) & mask
    if not inside.any():
        return normals
    mean = normalize(normals[inside].mean(axis=0)[None])
    touched = area > 1e-3
    return _turned_where(touched, normals, _turns(mean, direction[None]) * area[touched][:, None])


def brush(normals: Floats, area: Floats, direction: Floats) -> Floats:
    """Return a map with normals rotated towards a direction, in proportion to the brush's coverage.

    Args:
        normals: (H, W, 3), unit normals.
        area: (H, W) in [0, 1], coverage of each pixel by the brush.
        direction: (3,), unit vector.
    """
    touched = area > 1e-3
    own = normals[touched]
    turns = _turns(own, np.broadcast_to(direction, own.shape)) * area[touched][:, None]
    return _turned_where(touched, normals, turns)


def smooth(normals: Floats, mask: BoolMask, area: Floats, width: float) -> Floats:
    """Return a map with the object's normals smoothed, in proportion to the brush's coverage.

    Args:
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.
        area: (H, W) in [0, 1], coverage of each pixel by the brush.
        width: width of the brush in pixels; a wider brush smooths more.
    """
    touched = (area > 1e-3) & mask
    if not touched.any():
        return normals
    sigma = AVERAGED * width
    box = around(touched, int(np.ceil(4 * sigma)) + 1)  # the reach of the Gaussian
    blurred = cv2.GaussianBlur(normals[box] * mask[box][..., None], (0, 0), sigma)
    mean = normalize(np.asarray(blurred, np.float32))
    inside = touched[box]
    own = normals[box][inside]
    smoothed = normals.copy()
    smoothed[box][inside] = _facing(own + area[box][inside][:, None] * (mean[inside] - own))
    return smoothed


def carve(normals: Floats, mask: BoolMask, points: Floats, widths: Floats, height: float) -> None:
    """Carve a line into the object as a rounded ridge or groove that is as wide as the line.

    Args:
        normals: (H, W, 3), unit normals; changed in place, because a drawing may have thousands of lines.
        mask: (H, W), the object.
        points: (K, 2), x and y in pixels.
        widths: (K,), width of the line at each point in pixels.
        height: height of the ridge as a fraction of half the width; negative for a groove.

    Example:
        The left side of a ridge faces left, and the left side of a groove faces right:

        >>> line, widths = np.array([[4.5, 0.0], [4.5, 9.0]]), np.array([6.0, 6.0])
        >>> for height in (0.5, -0.5):
        ...     flat = np.zeros((9, 9, 3), np.float32)
        ...     flat[..., 2] = 1
        ...     carve(flat, np.ones((9, 9), bool), line, widths, height)
        ...     print(bool(flat[4, 3, 0] < 0))
        True
        False
    """
    radii = np.maximum(widths / 2, 1)
    size = np.array(mask.shape[::-1])
    low = np.clip(np.floor(points.min(axis=0) - radii.max() - 1), 0, size).astype(int)
    high = np.clip(np.ceil(points.max(axis=0) + radii.max() + 1), 0, size).astype(int)
    if (high - low).min() < 2:
        return  # outside the map
    box = np.s_[low[1] : high[1], low[0] : high[0]]
    raised = np.zeros(mask[box].shape, np.float32)
    for k, part, along, distance in _pieces(raised, low, points, radii.max()):
        radius = radii[k] + along * (radii[min(k + 1, len(radii) - 1)] - radii[k])
        np.maximum(part, radius * np.clip(1 - (distance / radius) ** 2, 0, None) ** 2, out=part)
    down, right = np.gradient(np.float32(height) * raised)
    touched = ((down != 0) | (right != 0)) & mask[box]
    slopes = np.stack([-right[touched], down[touched], np.ones(touched.sum())], axis=-1)
    normals[box][touched] = reoriented(normals[box][touched][None], normalize(slopes)[None])[0]


def polygon(shape: tuple[int, int], points: Floats, soft: float) -> Floats:
    """Return the coverage of each pixel (H, W) by a closed polygon with a soft edge.

    Args:
        shape: (H, W).
        points: (K, 2), x and y in pixels.
        soft: width of the edge in pixels.
    """
    area = np.zeros(shape, np.uint8)
    cv2.fillPoly(area, [np.rint(points * 16 - 8).astype(np.int32)], 255, cv2.LINE_AA, 4)
    values = np.asarray(area, np.float32) / np.float32(255)
    return np.asarray(cv2.GaussianBlur(values, (0, 0), soft / 2), np.float32) if soft > 0.5 else values


def stroke(shape: tuple[int, int], points: Floats, width: float, soft: float) -> Floats:
    """Return the coverage of each pixel (H, W) by a brush stroke.

    Args:
        shape: (H, W).
        points: (K, 2), x and y in pixels; one point is a dab.
        width: width of the brush in pixels.
        soft: width of the fade as a fraction of the radius; at least one pixel.

    Example:
        >>> dab = stroke((1, 9), np.array([[4.5, 0.5]]), 8, 0.5)
        >>> dab.round(1).tolist()
        [[0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0]]
    """
    radius = max(width / 2, 1)
    away = np.full(shape, radius, np.float32)
    for _, part, _, distance in _pieces(away, np.zeros(2), points, radius):
        np.minimum(part, distance, out=part)
    share = np.clip((radius - away) / max(soft * radius, 1), 0, 1)
    return np.asarray(share * share * (3 - 2 * share), np.float32)


@dataclass(frozen=True)
class MaskStroke:
    """A stroke of the mask brush, or a click that fills an area between lines.

    Args:
        points: (K, 2), x and y in pixels; a click uses only the first.
        width: width of the brush in pixels.
        adds: whether the stroke adds to the object instead of cutting from it.
        fills: whether the stroke is a click, which fills the area around it.
    """

    points: Floats
    width: float
    adds: bool
    fills: bool = False


def paint_mask(inked: BoolMask, strokes: Iterable[MaskStroke]) -> NDArray[np.int8]:
    """Return 1 where the last stroke on a pixel adds to the mask, -1 where it cuts, and 0 elsewhere.

    Args:
        inked: (H, W), the lines that separate areas.
        strokes: strokes in chronological order.

    Example:
        A click between two lines:

        >>> inked = np.zeros((5, 7), bool)
        >>> inked[:, [2, 5]] = True
        >>> paint_mask(inked, [MaskStroke(np.array([[3.5, 2.5]]), 1, True, True)])[0].tolist()
        [0, 0, 0, 1, 1, 0, 0]
    """
    painted = np.zeros(inked.shape, np.int8)
    areas = None
    for each in strokes:
        if each.fills:
            if areas is None:
                areas = cv2.connectedComponents((~inked).view(np.uint8), connectivity=4)[1]
            column, row = np.clip(each.points[0].astype(int), 0, np.array(inked.shape[::-1]) - 1)
            if not inked[row, column]:
                painted[areas == areas[row, column]] = 1 if each.adds else -1
            continue
        area = np.zeros(inked.shape, np.uint8)
        line = np.rint(each.points * 16 - 8).astype(np.int32)
        cv2.polylines(
            area, [np.concatenate([line, line[-1:]])], False, 1, max(round(each.width), 1), cv2.LINE_8, 4
        )
        painted[area > 0] = 1 if each.adds else -1
    return painted


def _pieces(
    field: Floats, corner: NDArray[Any], points: Floats, reach: float
) -> Iterator[tuple[int, Floats, NDArray[np.floating], NDArray[np.floating]]]:
    """Yield the segments of a line with the part of a field that is within reach of each.

    A segment comes as its index, a view of the field, and for each pixel of the view the position along the
    segment, from 0 to 1, and the distance from it.

    Args:
        field: (H, W), an array that the caller writes to.
        corner: x and y of the field's upper left corner.
        points: (K, 2), x and y in pixels; the last point also counts as a segment.
        reach: reach in pixels.
    """
    for k, start in enumerate(points):
        end = points[min(k + 1, len(points) - 1)]
        left, top = np.maximum(np.floor(np.minimum(start, end) - reach - corner), 0).astype(int)
        right, bottom = np.maximum(np.ceil(np.maximum(start, end) + reach - corner), 0).astype(int)
        part = field[top:bottom, left:right]
        y, x = np.ogrid[top : top + part.shape[0], left : left + part.shape[1]]
        beside, below = x + (0.5 + corner[0] - start[0]), y + (0.5 + corner[1] - start[1])
        way = end - start
        along = np.clip((beside * way[0] + below * way[1]) / max(float(way @ way), 1e-12), 0, 1)
        yield k, part, along, np.hypot(beside - along * way[0], below - along * way[1])


def _wendland(distance: NDArray[np.floating]) -> Floats:
    near = np.clip(1 - distance, 0, None)
    return np.asarray(near**4 * (4 * distance + 1), np.float32)


def _turns(before: Floats, after: Floats) -> Floats:
    """Return the rotation vectors (K, 3) between two sets of unit vectors."""
    axis = np.cross(before, after)
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    angle = np.arctan2(sine, (before * after).sum(-1, keepdims=True))
    # Opposite vectors do not define an axis, so any perpendicular one is used.
    square = np.cross(before, np.where(np.abs(before[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    square /= np.maximum(np.linalg.norm(square, axis=-1, keepdims=True), 1e-12)
    return np.asarray(np.where(sine > 1e-6, axis / np.maximum(sine, 1e-6), square) * angle, np.float32)


def _turned_where(touched: BoolMask, normals: Floats, turns: Floats) -> Floats:
    """Return a map (H, W, 3) with touched pixels rotated by vectors (K, 3), but kept facing the viewer."""
    turned = normals.copy()
    turned[touched] = _facing(_turned(normals[touched], turns))
    return turned


def _turned(vectors: Floats, turns: Floats) -> Floats:
    """Return vectors (N, 3) rotated by rotation vectors (Rodrigues' formula)."""
    angle = np.linalg.norm(turns, axis=-1, keepdims=True)
    axis = turns / np.maximum(angle, 1e-12)
    along = (axis * vectors).sum(-1, keepdims=True) * axis
    turned = vectors * np.cos(angle) + np.cross(axis, vectors) * np.sin(angle) + along * (1 - np.cos(angle))
    return np.asarray(turned, np.float32)


def _facing(vectors: Floats) -> Floats:
    """Return unit vectors (N, 3) with negative z clipped to 0, so that none faces away from the viewer."""
    vectors[:, 2] = np.maximum(vectors[:, 2], 0)
    return normalize(vectors)
