"""Types of the NumPy arrays used throughout the package."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
"""Images, normals and other single-precision values."""
Doubles = NDArray[np.float64]
"""Double-precision geometry."""
BoolMask = NDArray[np.bool_]
"""A mask of pixels or elements."""
Indices = NDArray[np.int64]
"""Indices of vertices, faces or other elements."""
