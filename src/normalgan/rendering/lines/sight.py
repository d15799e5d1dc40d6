"""Sight: the ray of every pixel, and the size of a pixel on the object."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Floats
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps

__all__ = ["Sight", "sight"]


@dataclass(frozen=True)
class Sight:
    """The ray of every pixel, which runs along (x, y, -1) in camera space.

    Args:
        x: (W,) slope to the right of the rays of each column; 0 under orthographic projection.
        y: (H,) slope upwards of the rays of each row; 0 under orthographic projection.
        pixel: (H, W) side of a pixel where its ray meets the surface, in units of the mesh; 0 off the
            object under perspective.
    """

    x: Floats
    y: Floats
    pixel: Floats


def sight(camera: Camera, maps: Maps, window: tuple[slice, slice], side: int) -> Sight:
    """Return the rays of a part of the frame.

    Args:
        camera: whose frame it is.
        maps: the visible surface in that part, (H, W).
        window: rows and columns of the part.
        side: side of the whole frame in pixels.
    """
    left, right, bottom, top = camera.window
    height, width = maps.mask.shape
    pixel = np.float32((right - left) / side)
    if not camera.perspective:
        return Sight(
            np.zeros(width, np.float32), np.zeros(height, np.float32), np.full_like(maps.depth, pixel)
        )
    rows, columns = (np.arange(part.start, part.stop) + 0.5 for part in window)
    x = (left + (right - left) * columns / side).astype(np.float32)
    y = (top + (bottom - top) * rows / side).astype(np.float32)
    return Sight(x, y, np.where(maps.mask, maps.depth, 0) * pixel)
