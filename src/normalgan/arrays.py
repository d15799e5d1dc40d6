"""Arrays: the types of NumPy arrays in this package, each defined once."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["BoolMask", "Doubles", "Floats", "Indices"]

Floats = NDArray[np.float32]
"""Pictures, normals and other values in single precision."""
Doubles = NDArray[np.float64]
"""Geometry in double precision."""
BoolMask = NDArray[np.bool_]
"""Which pixels, or which elements, belong to something."""
Indices = NDArray[np.int64]
"""Numbers of vertices, faces or other elements."""
