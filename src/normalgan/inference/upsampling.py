"""Upsampling: a map of the model's size at the drawing's, with its edges on the drawing's lines."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.normals import Floats

_REACH = 1.0
"""How far values are gathered from, in pixels of the model."""
_BARRIER = 6.0
"""What crossing a line costs, in reaches."""
_ROUNDS = 2


def sharpen(values: Floats, weight: Floats, ink: Floats, mask: NDArray[np.bool_], scale: float) -> Floats:
    """Return enlarged values that do not blend across lines, (H, W, C).

    Enlarging blends both sides of an edge over some pixels of the model. Here each pixel, as far as its own
    value is not to be trusted, gathers those about it by weight, and those on the far side of a line hardly
    count: the domain transform of Gastal and Oliveira 2011, "Domain Transform for Edge-Aware Image and Video
    Processing", with recursive filtering, normalised by weight, and with the lines and the mask's edge as
    what makes distances long.

    Args:
        values: (H, W, C), enlarged by interpolation.
        weight: (H, W) in [0, 1], how far each is to be trusted: little near lines.
        ink: (H, W), the drawing's lines.
        mask: (H, W), the object.
        scale: pixels of the drawing for each of the model.
    """
    trusted = np.where(mask, weight, 0)[..., None] ** 2
    weight = np.where(mask, weight + 1e-3, 1e-6).astype(np.float32)
    carried = np.dstack([values * weight[..., None], weight])
    reach = _REACH * scale
    cost = _BARRIER * reach * np.maximum(_middles(ink), _rim(mask))
    for i in range(_ROUNDS):
        # Gastal and Oliveira, equation 14: rounds of falling reach, so that no stripes are left.
        now = reach * np.sqrt(3) * 2 ** (_ROUNDS - i - 1) / np.sqrt(4**_ROUNDS - 1)
        decay = np.exp(-np.sqrt(2) / now * (1 + cost)).astype(np.float32)
        carried = _filtered(carried, decay)
        carried = _filtered(carried.transpose(1, 0, 2), decay.T).transpose(1, 0, 2)
    gathered = carried[..., :-1] / carried[..., -1:]
    return np.asarray(trusted * values + (1 - trusted) * gathered, np.float32)


def _filtered(values: Floats, decay: Floats) -> Floats:
    """Return values (H, W, C) after a pass down and a pass up."""
    out = np.ascontiguousarray(values)
    # Between two rows the dearer of both decides.
    between = np.minimum(decay[1:], decay[:-1])[..., None]
    for y in range(1, len(out)):
        out[y] += between[y - 1] * (out[y - 1] - out[y])
    for y in range(len(out) - 2, -1, -1):
        out[y] += between[y] * (out[y + 1] - out[y])
    return out


def _middles(ink: Floats) -> Floats:
    """Return 1 along the middle of lines and next to nothing at their edges, (H, W)."""
    inked = (ink > 0.35).astype(np.uint8)
    depth = cv2.distanceTransform(np.pad(inked, 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    size = 2 * int(np.ceil(np.median(depth[inked > 0]))) + 1 if inked.any() else 3
    deepest = cv2.dilate(depth, np.ones((size, size), np.uint8))
    return np.asarray((depth / np.maximum(deepest, 1)) ** 4, np.float32)


def _rim(mask: NDArray[np.bool_]) -> Floats:
    inside = mask.astype(np.uint8)
    return (inside - cv2.erode(inside, np.ones((3, 3), np.uint8), borderValue=1)).astype(np.float32)
