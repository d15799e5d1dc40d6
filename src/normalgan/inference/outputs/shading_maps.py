"""Shading maps: what else engines shade by: curvature and gloss; occlusion is a module of its own."""

import cv2
import numpy as np
from scipy import ndimage

from normalgan.arrays import BoolMask, Floats

__all__ = ["curvature", "gloss"]

_FINE = 1 / 256
"""Width at which a surface is looked at for its curvature, as a share of a drawing's longer side."""
_BEND = 0.04
"""Share of a drawing's longer side that is the radius of a ball that is half as light as can be."""


def curvature(normals: Floats, mask: BoolMask, longest: int | None = None) -> Floats:
    """Return how a surface bends, (H, W) in [0, 1]: ridges light, hollows dark, 0.5 where it is flat.

    It is the divergence of the normals, twice the mean curvature where the surface faces the viewer.

    Args:
        normals: (H, W, 3), unit on the object.
        mask: (H, W), the object; off it is 0.5.
        longest: longer side in pixels of the drawing, if its repeats are about it; None is that of the map.
    """
    if not mask.any():
        return np.full(mask.shape, 0.5, np.float32)
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    side = int(stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max())  # of a drawing, not of its sheet
    side = min(side, longest or side)
    width = max(_FINE * side, 0.7)
    # Off the object a sheet is flat: what counts there are the nearest normals on it.
    nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    smooth = cv2.GaussianBlur(normals[nearest[0], nearest[1], :2], (0, 0), width)
    bend = np.gradient(smooth[..., 0], axis=1) - np.gradient(smooth[..., 1], axis=0)  # rows count down
    return np.where(mask, 0.5 + 0.5 * np.tanh(bend * side * _BEND / 2), 0.5).astype(np.float32)


def gloss(open_to_light: Floats, bends: Floats, mask: BoolMask) -> Floats:
    """Return how much each place reflects, (H, W) in [0, 1]: ridges are polished, hollows dull, off it is 0.

    Args:
        open_to_light: (H, W), of `occlusion.occlusion`.
        bends: (H, W), of `curvature`.
        mask: (H, W), the object.
    """
    return np.where(mask, np.clip(open_to_light * bends, 0, 1), 0).astype(np.float32)
