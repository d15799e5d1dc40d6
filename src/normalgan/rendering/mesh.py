"""Meshes as the renderers take them, and how files in any disorder become so."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh ready to render: centred, of unit radius, y up, its normals outward.

    Args:
        name: what the user calls it (file name without suffix); enters seeds and messages.
        vertices: (V, 3) positions; the bounding sphere about the origin has radius 1.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        normals: (V, 3) unit vertex normals.
    """

    name: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    normals: NDArray[np.float32]
