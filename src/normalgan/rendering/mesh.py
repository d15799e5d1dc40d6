"""Meshes for renderers, their sources, and the check of loaded meshes."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh ready to render: centred, with unit radius, y up and outward normals.

    Args:
        name: name of the mesh (file name without extension), used for seeds and messages.
        vertices: (V, 3) positions; the bounding sphere around the origin has radius 1.
        faces: (F, 3) vertex indices, counter-clockwise when viewed from outside.
        normals: (V, 3) unit vertex normals.
    """

    name: str
    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats


class MeshSource(Protocol):
    """A source of a mesh, which is cheap to keep and to send to a worker process."""

    @property
    def name(self) -> str:
        """Name of the mesh: a file name without extension, or a species with a number."""

    def fingerprint(self) -> str:
        """Return a hash of everything that `load` depends on: file bytes, orientation, parameters."""

    def load(self) -> Mesh:
        """Return the mesh.

        Raises:
            InputError: if the mesh cannot be used; the message contains its name and the reason.
        """


def check_mesh(loaded: object) -> Mesh:
    """Return a data source's mesh after checking it.

    Raises:
        InputError: if the mesh is invalid.
    """
    if not isinstance(loaded, Mesh):
        raise InputError(f"its load gave {type(loaded).__name__}; it must be a normalgan.rendering.Mesh.")
    for part, wanted, kind in (
        ("vertices", "(V, 3) finite floats", np.floating),
        ("faces", "(F, 3) whole numbers", np.integer),
        ("normals", "(V, 3) finite floats", np.floating),
    ):
        if not _is_rows_of_three(getattr(loaded, part), kind):
            raise InputError(f"its load gave a Mesh whose {part} are not an array of {wanted}.")
    if len(loaded.normals) != len(loaded.vertices):
        raise InputError(
            f"its load gave a Mesh of {len(loaded.vertices)} vertices and {len(loaded.normals)} normals; "
            "each vertex has one."
        )
    if loaded.faces.min() < 0 or loaded.faces.max() >= len(loaded.vertices):
        raise InputError(
            f"its load gave a Mesh whose faces name the vertices {loaded.faces.min()} to "
            f"{loaded.faces.max()}; it has 0 to {len(loaded.vertices) - 1}."
        )
    return loaded


def _is_rows_of_three(value: object, kind: type[np.generic]) -> bool:
    if not isinstance(value, np.ndarray):
        return False
    array: NDArray[Any] = value
    shaped = array.ndim == 2 and array.shape[-1] == 3 and len(array) > 0
    return shaped and np.issubdtype(array.dtype, kind) and bool(np.isfinite(array).all())
