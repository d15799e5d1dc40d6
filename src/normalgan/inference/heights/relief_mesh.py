"""Relief mesh: a closed mesh of a height map, for engines, viewers and 3D printers."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.heights.relief_outline import Corners, corners_of
from normalgan.inference.reading.picture import resize

_DEPTH = 0.5
"""Factor applied to the heights; 1 would keep the object's full depth, and 0.2 is a bas-relief."""
_THICKNESS = 0.03
"""Minimum thickness of the relief, as a fraction of the picture's longer side."""


def relief_mesh(height: Floats, mask: NDArray[np.bool_]) -> Any:
    """Return a closed relief with a flat back as a `trimesh.Trimesh`; x right, y up, z to the viewer.

    The picture is centred at the origin, and its longer side has length 1. Each pixel becomes two triangles.
    The pixel staircase of the outline is smoothed.

    Args:
        height: (H, W), height in pixels towards the viewer, as returned by `heights.height.integrate`.
        mask: (H, W), True on the object.

    Raises:
        InputError: if the mask is empty or has a different size.
    """
    import trimesh

    if height.shape != mask.shape:
        raise InputError(f"heights of {height.shape} do not match a mask of {mask.shape}; sizes must agree.")
    if not mask.any():
        raise InputError("a relief needs an object, but the mask is empty.")
    corners, long = corners_of(height, mask), max(mask.shape)
    size = np.array([mask.shape[1], mask.shape[0]]) / long
    place = (corners.place / long - size / 2) * [1, -1]  # rows go down, y goes up
    front = np.column_stack([place, _DEPTH * corners.height / long])
    return trimesh.Trimesh(*_close(front, corners, float(front[:, 2].min()) - _THICKNESS), process=False)


def encode_relief(mesh: Any, form: Literal["glb", "obj"]) -> bytes:
    """Return the content of a relief's file."""
    if form == "glb":
        from trimesh.exchange.gltf import export_glb

        content: bytes = export_glb(mesh.scene(), include_normals=True)
        return content
    from trimesh.exchange.obj import export_obj

    text: str = export_obj(mesh, include_normals=True)
    return text.encode()


def simpler(height: Floats, mask: NDArray[np.bool_], faces: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return heights and mask reduced until their relief has at most ``faces`` triangles.

    Args:
        height: (H, W), height in pixels towards the viewer.
        mask: (H, W), the object; not empty.
        faces: maximum number of triangles; the relief of a single pixel is always allowed.
    """
    small, there, factor = height, mask, 1.0
    while _closed_faces(there) > faces and min(there.shape) > 1:
        factor *= min(float(np.sqrt(faces / _closed_faces(there))), 0.97)
        shape = max(round(mask.shape[0] * factor), 1), max(round(mask.shape[1] * factor), 1)
        share = resize(mask.astype(np.float32), shape)
        total = resize(np.where(mask, height, np.float32(0)), shape)  # the height off the object is undefined
        there = share > min(0.5, float(share.max()) / 2)
        small = np.where(there, total / np.maximum(share, 1e-6), 0).astype(np.float32) * np.float32(factor)
    return small, there


def _closed_faces(mask: NDArray[np.bool_]) -> int:
    """Return the number of triangles of a mask's relief: four per pixel and two per outline edge."""
    around = np.pad(mask, 1)
    edges = sum(int((around & ~np.roll(around, step, axis)).sum()) for step in (1, -1) for axis in (0, 1))
    return 4 * int(mask.sum()) + 2 * edges


def _close(front: NDArray[np.float64], corners: Corners, floor: float) -> tuple[Any, Any]:
    """Return the vertices and faces of a mesh closed with sides and a flat back at z = ``floor``."""
    back = front.copy()
    back[:, 2] = floor
    n, (start, end) = len(front), corners.rim.T
    # The rim runs in the direction of the front faces, with the object on its left. The side faces share its
    # edges in the opposite direction.
    sides = np.concatenate(
        [np.column_stack([end, start, start + n]), np.column_stack([end, start + n, end + n])]
    )
    faces = np.concatenate([corners.faces, corners.faces[:, ::-1] + n, sides])
    return np.concatenate([front, back]), faces
