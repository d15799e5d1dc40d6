"""Occlusion: compute ambient occlusion from heights and normals."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.reading.picture import fitted, resize

_SIDE = 512
"""Maximum longer side in pixels at which occlusion, which is smooth, is computed."""
_WAYS = 12
"""Number of search directions."""
_REACH = 0.12
"""Reach of the search, as a fraction of the longer side."""
_STEPS = 7
_BIAS = 0.12
"""Minimum rise, as a sine, that occludes; smaller rises come from noise, or from steep heights at the rim."""


def occlusion(height: Floats, normals: Floats, mask: NDArray[np.bool_], longest: int | None = None) -> Floats:
    """Return the fraction of the sky (H, W) that is visible from each pixel of a surface; 1 off the object.

    Args:
        height: (H, W), height in pixels towards the viewer.
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.
        longest: longer side of the drawing in pixels, if the arrays are padded with its repeats; None uses
            the longer side of the arrays.

    References:
        Bavoil, Sainz, Dimitrov 2008, "Image-space horizon-based ambient occlusion".

    Example:
        >>> y, x = np.mgrid[-32:32, -32:32] + 0.5
        >>> groove = np.abs(x).astype(np.float32)
        >>> lean = np.stack([-np.sign(x), 0 * x, np.ones_like(x)], -1).astype(np.float32) / np.float32(2**0.5)
        >>> open_sky = occlusion(groove, lean, np.ones((64, 64), bool))
        >>> bool(open_sky[32, 32] < 0.8 < open_sky[32, 60])
        True
    """
    shape = (mask.shape[0], mask.shape[1])
    longest = longest or max(shape)
    small = fitted(shape, round(_SIDE * max(shape) / longest)) if longest > _SIDE else shape
    scale = small[1] / shape[1]
    cover = resize(mask.astype(np.float32), small) > 0.5
    level = resize(np.where(mask, height, 0).astype(np.float32), small) * np.float32(scale)
    facing = resize(normals, small)
    depth = np.maximum(facing[..., 2], 0.1)
    reach = max(_REACH * longest * scale, 4.0)
    far = np.geomspace(1.5, reach, _STEPS)
    hidden = np.zeros(small, np.float32)
    rows, columns = (grid.astype(np.float32) for grid in np.mgrid[: small[0], : small[1]])
    for angle in np.arange(_WAYS) * (2 * np.pi / _WAYS):
        right, down = float(np.cos(angle)), float(np.sin(angle))
        # Slope of the surface itself in this direction; only heights above the tangent plane occlude.
        slope = -(facing[..., 0] * right - facing[..., 1] * down) / depth
        tangent = slope / np.sqrt(1 + slope**2)
        worst = np.zeros(small, np.float32)
        for distance in far:
            x, y = columns + np.float32(distance * right), rows + np.float32(distance * down)
            there = cv2.remap(level, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            on = cv2.remap(cover.astype(np.float32), x, y, cv2.INTER_LINEAR) > 0.99
            rise = (there - level) / np.float32(distance)
            sine = rise / np.sqrt(1 + rise**2)
            fading = np.float32(1 - (distance / reach) ** 2 * 0.9)
            worst = np.maximum(worst, np.where(on, (sine - tangent - _BIAS) * fading, 0))
        hidden += worst
    open_sky = np.where(cover, 1 - np.clip(hidden / _WAYS, 0, 1), 1).astype(np.float32)
    open_sky = np.asarray(cv2.GaussianBlur(open_sky, (0, 0), 0.8), np.float32)
    return np.where(mask, np.clip(resize(open_sky, shape), 0, 1), np.float32(1))
