"""Shading maps: what else engines shade by, from normals and heights: occlusion, curvature, gloss."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from normalgan.normals import Floats
from normalgan.painting.picture import fitted, resize

__all__ = ["curvature", "gloss", "occlusion"]

_SIDE = 1024
"""Longest side at which occlusion is looked for; it is smooth."""
_WAYS = 8
_REACHES = (1 / 128, 1 / 64, 1 / 32, 1 / 16)
"""How far neighbours are looked at, as shares of the longer side."""
_FINE = 1 / 256
"""Width at which a surface is looked at for its curvature, as a share of a drawing's longer side."""
_BEND = 0.04
"""Share of a drawing's longer side that is the radius of a ball that is half as light as can be."""
_Mask = NDArray[np.bool_]


def occlusion(height: Floats, normals: Floats, mask: _Mask) -> Floats:
    """Return how open each place is to light, (H, W) in [0, 1]: 1 in the open, and off the object.

    In each of some directions, the neighbour that rises most above the plane of the pixel's own normal hides
    what is below it.

    Args:
        height: (H, W) in pixels towards the viewer.
        normals: (H, W, 3), unit.
        mask: (H, W), the object.

    References:
        Bavoil, Sainz, Dimitrov 2008, "Image-space horizon-based ambient occlusion", SIGGRAPH talks.
    """
    shape = mask.shape
    if max(shape) > _SIDE:
        small = fitted((shape[0], shape[1]), _SIDE)
        factor = small[0] / shape[0]
        there = resize(mask.astype(np.float32), small) > 0.5
        found = occlusion(resize(height, small) * np.float32(factor), resize(normals, small), there)
        return np.where(mask, np.clip(resize(found, (shape[0], shape[1])), 0, 1), 1).astype(np.float32)
    known = np.where(mask, height, np.float32(-1e6))
    facing = np.maximum(normals[..., 2], 0.1)
    hidden = np.zeros(shape, np.float32)
    for way in range(_WAYS):
        across, up = np.cos(2 * np.pi * way / _WAYS), np.sin(2 * np.pi * way / _WAYS)
        plane = -(normals[..., 0] * across + normals[..., 1] * up) / facing
        steepest = plane.copy()
        for reach in _REACHES:
            x, y = round(across * reach * max(shape)), -round(up * reach * max(shape))
            far = float(np.hypot(x, y))
            if far:
                steepest = np.maximum(steepest, (_shifted(known, y, x) - height) / np.float32(far))
        hidden += _sine(steepest) - _sine(plane)
    return np.where(mask, np.clip(1 - hidden / _WAYS, 0, 1), 1).astype(np.float32)


def curvature(normals: Floats, mask: _Mask) -> Floats:
    """Return how a surface bends, (H, W) in [0, 1]: ridges light, hollows dark, 0.5 where it is flat.

    It is the divergence of the normals, twice the mean curvature where the surface faces the viewer.

    Args:
        normals: (H, W, 3), unit on the object.
        mask: (H, W), the object; off it is 0.5.
    """
    if not mask.any():
        return np.full(mask.shape, 0.5, np.float32)
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    side = int(stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max())  # of a drawing, not of its sheet
    width = max(_FINE * side, 0.7)
    # Off the object a sheet is flat: what counts there are the nearest normals on it.
    nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    smooth = cv2.GaussianBlur(normals[nearest[0], nearest[1], :2], (0, 0), width)
    bend = np.gradient(smooth[..., 0], axis=1) - np.gradient(smooth[..., 1], axis=0)  # rows count down
    return np.where(mask, 0.5 + 0.5 * np.tanh(bend * side * _BEND / 2), 0.5).astype(np.float32)


def gloss(open_to_light: Floats, bends: Floats, mask: _Mask) -> Floats:
    """Return how much each place reflects, (H, W) in [0, 1]: ridges are polished, hollows dull, off it is 0.

    Args:
        open_to_light: (H, W), of `occlusion`.
        bends: (H, W), of `curvature`.
        mask: (H, W), the object.
    """
    return np.where(mask, np.clip(open_to_light * bends, 0, 1), 0).astype(np.float32)


def _shifted(values: Floats, rows: int, columns: int) -> Floats:
    """Return what lies so many rows below and columns to the right of each pixel; nothing beyond the edge."""
    matrix = np.array([[1, 0, -columns], [0, 1, -rows]], np.float64)
    size = (values.shape[1], values.shape[0])
    return np.asarray(
        cv2.warpAffine(values, matrix, size, flags=cv2.INTER_NEAREST, borderValue=(-1e6,)), np.float32
    )


def _sine(slope: Floats) -> Floats:
    return np.asarray(slope / np.sqrt(1 + slope * slope), np.float32)
