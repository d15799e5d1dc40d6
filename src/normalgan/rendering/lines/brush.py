"""Brush: strokes with a width that follows the shading, like those of a brush pen."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats, Indices
from normalgan.ranges import NonNegative, Positive
from normalgan.rendering.lines.base import LINE_DRAWINGS
from normalgan.rendering.lines.buffers import BufferedDrawing, Buffers
from normalgan.rendering.lines.contours import mark, occluding_contours
from normalgan.rendering.strokes.chain import chain
from normalgan.rendering.strokes.curves import SPACING, resample, settle, smooth
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

_BLUR_RATIO = 1.6  # ratio of the blurs that best approximates a Laplacian (Marr, Hildreth 1980)
_SHORTEST_STROKE = 1.5  # minimum length of a stroke in ink widths; shorter ones are spurs
_LINE_SMOOTHING = 7.0  # points for smoothing the centre line, which jumps from pixel to pixel
_WIDTH_SMOOTHING = 6.0  # points for smoothing its width


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class Brush(BufferedDrawing):
    """Brush strokes that are thick where the surface turns away slowly and thin where it turns away quickly.

    There is ink where an extended difference of Gaussians of n·v falls below a threshold (Winnemöller,
    Kyprianidis, Olsen, "XDoG: An eXtended Difference-of-Gaussians Compendium", Computers & Graphics 36(6),
    2012, equation 7). Strokes follow the centre line of the ink and have its width.

    Args:
        line_width: median width of the strokes in pixels of the sketch, at any sketch size.
        widest: maximum width of a stroke relative to the median, so that broad shadows do not become
            blots.
        sigma: standard deviation of the smaller blur, as a fraction of the frame's side.
        sharpening: strength p of the emphasis of edges over shading.
        threshold: epsilon, the sharpened n·v below which there is ink. If it is above 0, flat faces with a
            smaller n·v turn black.
        gap: minimum depth discontinuity at a contour, beyond the change explained by the slope, as a
            fraction of the frame's side. Contours are always inked.
        shortest_contour: minimum extent of a contour, as a fraction of the frame's side.
        shortest: minimum extent of a patch of ink, as a fraction of the frame's side.
    """

    line_width: Positive = 2.0
    widest: Positive = 2.0
    sigma: Positive = 0.005
    sharpening: NonNegative = 50.0
    threshold: NonNegative = 0.0
    gap: Positive = 0.01
    shortest_contour: NonNegative = 0.012
    shortest: NonNegative = 0.045

    def _draw(self, view: View, buffers: Buffers) -> list[Stroke]:
        contours = mark(occluding_contours(buffers, self.gap, self.shortest_contour), buffers.maps.mask.shape)
        facing = np.where(contours, 0, _facing_ratio(buffers))
        sharp = _sharpened(facing, self.sigma * buffers.side, self.sharpening)
        inked = _without_specks(contours | (sharp < self.threshold), self.shortest * buffers.side)
        # Uneven ink gives the centre line spurs that end inside the ink.
        lines = [
            line for line in thin(inked) if len(line[0]) >= max(_SHORTEST_STROKE * np.median(line[1]), 2)
        ]
        if not lines:
            return []
        median = float(np.median(np.concatenate([width for _, width in lines])))
        return [self._stroke(points, width / median, buffers) for points, width in lines]

    def _stroke(self, points: Doubles, width: Doubles, buffers: Buffers) -> Stroke:
        """Return the stroke along ``points`` (P, 2) of the buffers, with relative widths ``width`` (P,)."""
        path = resample(buffers.to_sketch(settle(points, _LINE_SMOOTHING, 1.5)), SPACING)
        closed = bool((points[0] == points[-1]).all())
        number = np.zeros(len(width)) if closed else np.arange(len(width))
        swelling = smooth(np.stack([width, number], axis=1), _WIDTH_SMOOTHING)[:, 0]
        here = np.interp(np.linspace(0, len(width) - 1, len(path)), np.arange(len(width)), swelling)
        return Stroke(path, self.line_width * np.clip(here, 0.1, self.widest), np.ones(len(path)))


def _facing_ratio(buffers: Buffers) -> Floats:
    """Return n·v of each pixel (H, W), from 0 to 1, with 1 outside the object."""
    facing = np.clip(buffers.sight.facing(buffers.maps.normal), 0, 1)
    return np.where(buffers.maps.mask, facing, 1).astype(np.float32)


def _sharpened(picture: Floats, sigma: float, sharpening: float) -> Floats:
    """Return ``(1 + p) G_sigma - p G_(1.6 sigma)`` of a picture (H, W), sigma in pixels."""
    near, far = (cv2.GaussianBlur(picture, (0, 0), width) for width in (sigma, _BLUR_RATIO * sigma))
    return (1 + sharpening) * near - sharpening * far


def _without_specks(inked: BoolMask, shortest: float) -> BoolMask:
    """Return the inked pixels (H, W) without connected patches with an extent below ``shortest`` pixels.

    The extent of a patch is the longer side of its bounding box. Pixels are 8-connected.

    >>> _without_specks(np.array([[1, 1, 1, 0, 1]], bool), 2).astype(int)
    array([[1, 1, 1, 0, 0]])
    """
    _, labels, stats, _ = cv2.connectedComponentsWithStats(inked.astype(np.uint8), connectivity=8)
    large = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT]) >= shortest
    large[0] = False
    kept: BoolMask = large[labels]
    return kept


def thin(inked: BoolMask) -> list[tuple[Doubles, Doubles]]:
    """Return the centre lines of inked areas, and the width of the ink along them.

    The algorithm is that of Zhang and Suen, "A Fast Parallel Algorithm for Thinning Digital Patterns",
    1984, from scikit-image.

    Args:
        inked: (H, W), True at inked pixels.

    Returns:
        For each line, its points (P, 2), x right and y down in pixels, and widths (P,) in pixels.

    >>> inked = np.zeros((9, 20), bool)
    >>> inked[3:6, 2:18] = True
    >>> [(points, width)] = thin(inked)
    >>> points[5:8].tolist(), width[5:8].tolist()
    ([[11.5, 4.5], [10.5, 4.5], [9.5, 4.5]], [3.0, 3.0, 3.0])
    """
    from skimage.morphology import skeletonize  # takes half a second to import, and only brushes need it

    skeleton: BoolMask = skeletonize(inked)
    rows, columns = np.nonzero(skeleton)
    if not len(rows):
        return []
    # The distance between pixel centres exceeds the distance to the edge of the ink by half a pixel.
    depth = cv2.distanceTransform(np.pad(inked, 1).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    width = 2 * depth[1:-1, 1:-1][rows, columns].astype(np.float64) - 1
    points = np.stack([columns + 0.5, rows + 0.5], axis=1)
    links = _neighbours(skeleton, rows, columns)
    return [(points[path], width[path]) for path in (chain(points, links) if len(links) else [])]


def _neighbours(skeleton: BoolMask, rows: Indices, columns: Indices) -> Indices:
    """Return pairs of neighbouring skeleton pixels, (L, 2); diagonal ones only if no side connects them."""
    number = np.full((skeleton.shape[0] + 2, skeleton.shape[1] + 2), -1)
    number[rows + 1, columns + 1] = np.arange(len(rows))
    links = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        other = number[rows + 1 + down, columns + 1 + right]
        near = other >= 0
        if down and right:
            near &= (number[rows + 2, columns + 1] < 0) & (number[rows + 1, columns + 1 + right] < 0)
        links.append(np.stack([np.flatnonzero(near), other[near]], axis=1))
    return np.concatenate(links)
