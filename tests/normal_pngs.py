"""Reading of the normal maps that the package writes, by OpenCV alone."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.normals import decode


def read_png(path: str | Path) -> tuple[Floats, Floats]:
    """Return the unit normals (H, W, 3), and the opacity (H, W), which is 1 where the file has no alpha."""
    pixels: Any = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert pixels is not None, path
    top = np.float32(np.iinfo(pixels.dtype).max)
    alpha = pixels[..., 3] / top if pixels.shape[2] == 4 else np.ones(pixels.shape[:2])
    return decode(pixels[..., 2::-1]), alpha.astype(np.float32)
