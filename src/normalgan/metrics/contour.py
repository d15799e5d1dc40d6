"""Distance of pixels from the object's contour."""

import cv2
import numpy as np
import torch
from torch import Tensor

from normalgan.arrays import BoolMask, Floats


def distance_from_contour(mask: Tensor) -> Tensor:
    """Return the distance of each pixel from the contour, in pixels; 0 outside the object.

    The contour runs halfway between object pixels and background pixels, so the outermost object pixels
    have a distance of 0.5. There is no contour where the picture's border cuts the object.

    Args:
        mask: (N, 1, H, W), 1 on the object.

    Returns:
        (N, 1, H, W) in float32, on the CPU; infinite where the object fills the whole picture.

    Example:
        >>> distance_from_contour(torch.tensor([0.0, 1, 1, 1]).view(1, 1, 1, 4))[0, 0, 0].tolist()
        [0.0, 0.5, 1.5, 2.5]
    """
    inside = mask[:, 0].cpu().numpy() > 0.5
    return torch.from_numpy(np.stack([_of_one(one) for one in inside]))[:, None]


def _of_one(inside: BoolMask) -> Floats:
    if inside.all():
        return np.full(inside.shape, np.inf, np.float32)
    distance = cv2.distanceTransform(inside.view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.where(inside, distance - np.float32(0.5), np.float32(0))
