"""Upsampling: a map of the model's size at the drawing's, with its edges on the drawing's lines."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.normals import Floats

_REACH = 1.25
"""How far beside a line values are those of both its sides, in pixels of the model."""
_INK = 0.35
_RIDGE = 0.9
"""Where lines are dense, what is nearly as far from them as anything about it is trusted."""


def sharpen(values: Floats, ink: Floats, mask: NDArray[np.bool_], scale: float) -> Floats:
    """Return enlarged values that do not blend across lines, (H, W, C).

    Enlarging blends both sides of a line over some pixels of the model. Here a pixel that near to a line
    takes the value of the nearest pixel that is not. As that one lies on the same side, values change in the
    middle of the line, and in between they are as the model has them. Between lines that are closer to one
    another the pixels half-way count as far.

    Args:
        values: (H, W, C), enlarged by interpolation.
        ink: (H, W), the drawing's lines.
        mask: (H, W), the object; what is beside it is not trusted.
        scale: pixels of the drawing for each of the model.
    """
    trusted = mask & _far((ink > _INK).astype(np.uint8), _REACH * scale)
    if not trusted.any():
        return values
    _, labels = cv2.distanceTransformWithLabels(
        (~trusted).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    # Each trusted pixel has a label of its own, which its neighbours share.
    place = np.zeros(int(labels.max()) + 1, np.intp)
    sources = np.flatnonzero(trusted)
    place[labels.ravel()[sources]] = sources
    gathering = np.flatnonzero(~trusted & mask)
    out = values.copy()
    flat = out.reshape(-1, out.shape[-1])
    flat[gathering] = flat[place[labels.ravel()[gathering]]]
    return out


def _far(inked: NDArray[np.uint8], reach: float) -> NDArray[np.bool_]:
    """Return where there is no line within reach, or none nearer than for all around, (H, W)."""
    away = cv2.distanceTransform(1 - inked, cv2.DIST_L2, 5)
    # A wider window would look across the line into wider parts.
    width = 2 * int(np.ceil(reach / 2)) + 1
    farthest = cv2.dilate(away, cv2.getStructuringElement(cv2.MORPH_RECT, (width, width)))
    far: NDArray[np.bool_] = away >= np.minimum(np.float32(_RIDGE) * farthest, np.float32(reach))
    return far & (away > 0)
