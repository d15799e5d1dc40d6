"""Mesh, the input of the renderers, and MeshSource, which loads one."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats

__all__ = ["Mesh", "MeshSource"]


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh ready to render: centred, of unit radius, y up, its normals outward.

    Args:
        name: its name (file name without suffix); enters seeds and messages.
        vertices: (V, 3) positions; the bounding sphere about the origin has radius 1.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        normals: (V, 3) unit vertex normals.
    """

    name: str
    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats


class MeshSource(Protocol):
    """A source of one mesh, cheap to keep and to send to a worker process."""

    @property
    def name(self) -> str:
        """Its name: a file name without suffix, or a species with its number."""

    def fingerprint(self) -> str:
        """Return a hash of everything that `load` depends on: file bytes, orientation, parameters."""

    def load(self) -> Mesh:
        """Return the mesh.

        Raises:
            InputError: if it cannot be used; the message names it and says why.
        """
