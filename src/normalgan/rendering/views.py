"""Cameras: where the object is looked at from, and how it fills the frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Camera:
    """A pinhole or orthographic camera with a square frame, looking down its own -z axis.

    Args:
        rotation: (3, 3) world to camera; its rows are the camera's x (right), y (up) and z (to the viewer).
        translation: (3,) world to camera: ``p_camera = rotation @ p_world + translation``.
        perspective: whether lines meet in the eye (True) or run parallel to z (False).
        window: (left, right, bottom, top) of the frame: in camera units if orthographic, on the plane
            z = -1 if perspective. It need not be centred on the axis.
        near: distance to the near plane, positive.
        far: distance to the far plane, positive.
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    perspective: bool
    window: tuple[float, float, float, float]
    near: float
    far: float
