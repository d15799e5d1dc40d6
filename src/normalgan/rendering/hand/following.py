"""Apply a drawing's distortion to its normals, depth and mask."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats, Indices
from normalgan.rendering.hand.distortion import Distortion
from normalgan.rendering.maps import Maps

__all__ = ["follow"]

_ALIKE = 0.5  # neighbours whose normals differ more in a component belong to different surfaces


def follow(maps: Maps, distortion: Distortion) -> Maps:
    """Return the maps of an object after distorting its picture; depths stay.

    If point p of the picture moves to q, the height z(p) is found at q, and with J = dp/dq its gradient is
    J^T dz/dp. So (nx, ny) becomes J^T (nx, ny), nz is unchanged, and the vector is normalized. Of the four
    pixels around a source, only those on the object and on the surface of the nearest one are interpolated,
    so that neither the background nor a farther part blends in. The depth is that of the nearest.

    Args:
        maps: (H, W) of the object.
        distortion: distortion of the drawing.
    """
    place, jacobian = distortion.grid(*maps.mask.shape)
    x, y = (place * max(maps.mask.shape) - 0.5).astype(np.float32)  # pixel centres at integers
    mask = cv2.remap(maps.mask.astype(np.float32), x, y, cv2.INTER_LINEAR, borderValue=0) > 0.5
    at = np.flatnonzero(mask)
    normal, depth = _sample(maps, x, y, at)
    (xx, xy), (yx, yy) = jacobian.reshape(2, 2, -1)[:, :, at].astype(np.float32)
    nx, ny, nz = normal.T
    nx, ny = xx * nx - yx * ny, yy * ny - xy * nx  # J has y down, normals have y up
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    normals, depths = np.zeros_like(maps.normal), np.full_like(maps.depth, np.inf)
    normals.reshape(-1, 3)[at] = np.stack([nx / length, ny / length, nz / length], axis=1)
    depths.reshape(-1)[at] = depth
    return Maps(normals, depths, mask)


def _sample(maps: Maps, x: Floats, y: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Return normals (N, 3), not of unit length, and depths (N,) of the object.

    They are taken where ``x`` and ``y`` (H, W) say, in pixels of the maps, at the flat indices ``at``.
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
    """Return where a pixel and those to its right, below and between are of one surface, (H, W)."""
    square, corner = np.ones((2, 2), np.uint8), (0, 0)
    spread = cv2.dilate(maps.normal, square, anchor=corner) - cv2.erode(maps.normal, square, anchor=corner)
    alike = cv2.inRange(spread, (-1.0,) * 3, (_ALIKE,) * 3)
    whole = cv2.erode(maps.mask.astype(np.uint8), square, anchor=corner)
    one: BoolMask = (alike > 0) & (whole > 0)
    return one


def _sort_out(maps: Maps, x: Floats, y: Floats, left: Indices, top: Indices) -> tuple[Floats, Floats]:
    """Sample like `_sample` at places whose four pixels belong to different surfaces."""
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
    for index, share in zip(corners, weight, strict=True):
        normal = normals[index]
        total += (share * (np.abs(normal - own) <= _ALIKE).all(axis=1))[:, None] * normal
    return total, depths[nearest]
