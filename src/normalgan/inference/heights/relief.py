"""Relief: a mesh of a height map, closed at its sides, for engines, viewers and printers."""

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.inference.heights.relief_outline import Corners, corners_of
from normalgan.inference.reading.picture import resize

__all__ = [
    "SUFFIXES",
    "Backing",
    "check_relief_path",
    "encode_relief",
    "relief_mesh",
    "simpler",
    "write_relief",
]

Backing = Literal["open", "flat", "plate"]
SUFFIXES = (".glb", ".obj")


def relief_mesh(
    height: Floats,
    mask: NDArray[np.bool_],
    texture: NDArray[np.uint8] | None = None,
    backing: Backing = "flat",
    depth: float = 0.5,
    thickness: float = 0.03,
) -> Any:
    """Return a relief as a `trimesh.Trimesh`: x right, y up, z to the viewer.

    The picture is centred on the origin, and its longer side is one unit long. A pixel becomes two
    triangles; the outline, a staircase of pixels, is smoothed.

    Args:
        height: (H, W) in pixels towards the viewer, as `heights.height.integrate` returns it.
        mask: (H, W) True on the object.
        texture: (H', W', 3) sRGB picture that is laid over it from the front, or None.
        backing: ``open`` is the front alone; ``flat`` closes it by sides and a flat back, and is
            watertight; ``plate`` also sets it on a rectangle of the size of the picture.
        depth: what heights are multiplied by; 1 keeps the proportions, which makes sides as deep as the
            object, and 0.2 is a bas-relief.
        thickness: thickness of the thinnest place, and of the plate, in units of the picture's longer side.

    Raises:
        InputError: if the mask is empty or of another size, or a number cannot be used.
    """
    import trimesh
    from PIL import Image

    if height.shape != mask.shape:
        raise InputError(
            f"heights of {height.shape} do not go with a mask of {mask.shape}; sizes must agree."
        )
    if not mask.any():
        raise InputError("a relief needs an object, but the mask is empty.")
    if not depth > 0 or not thickness > 0:
        raise InputError(f"depth and thickness of a relief are greater than 0, not {depth} and {thickness}.")
    corners, long = corners_of(height, mask), max(mask.shape)
    size = np.array([mask.shape[1], mask.shape[0]]) / long
    place = (corners.place / long - size / 2) * [1, -1]  # rows count down
    front = np.column_stack([place, depth * corners.height / long])
    floor = float(front[:, 2].min()) - thickness
    vertices, faces = (front, corners.faces) if backing == "open" else _close(front, corners, floor)
    if backing == "plate":
        vertices, faces = _join(vertices, faces, *_plate(size, floor, thickness))
    visual = None
    if texture is not None:
        uv = vertices[:, :2] / size + 0.5
        picture = trimesh.visual.material.PBRMaterial(
            baseColorTexture=Image.fromarray(texture), metallicFactor=0.0, roughnessFactor=0.9
        )
        visual = trimesh.visual.TextureVisuals(uv=uv, material=picture)
    return trimesh.Trimesh(vertices, faces, visual=visual, process=False)


def encode_relief(mesh: Any, form: Literal["glb", "obj"]) -> bytes:
    """Return the file of a relief without a texture."""
    if form == "glb":
        from trimesh.exchange.gltf import export_glb

        content: bytes = export_glb(mesh.scene(), include_normals=True)
        return content
    return _obj(mesh, "")[0]


def write_relief(path: str | Path, mesh: Any) -> None:
    """Write a relief as ``.glb``, or as ``.obj`` with its ``.mtl`` and picture beside it.

    Raises:
        InputError: if the suffix is another.
        OSError: if it cannot be written.
    """
    path = check_relief_path(path)
    if path.suffix.lower() == ".glb":
        write_bytes(path, encode_relief(mesh, "glb"))
        return
    text, beside = _obj(mesh, "_".join(path.stem.split()))  # readers end a name at a space
    for name, content in beside.items():
        write_bytes(path.with_name(name), content)
    write_bytes(path, text)


def _obj(mesh: Any, stem: str) -> tuple[bytes, dict[str, bytes]]:
    """Return the content of an ``.obj``, and of the files beside it by their names."""
    from trimesh.exchange.obj import export_obj

    text, beside = export_obj(
        mesh, include_normals=True, include_texture=True, return_texture=True, mtl_name=f"{stem}.mtl"
    )
    # trimesh gives all reliefs of a folder the same picture.
    pictures = {name: f"{stem}_{name}" for name in beside if not name.endswith(".mtl")}
    files = {}
    for name, content in beside.items():
        data = content
        for old, new in pictures.items() if name.endswith(".mtl") else ():
            data = data.replace(old.encode(), new.encode())
        files[pictures.get(name, name)] = data
    return text.encode(), files


def simpler(height: Floats, mask: NDArray[np.bool_], faces: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return heights and mask of fewer pixels, whose relief with a flat back has at most ``faces`` triangles.

    Args:
        height: (H, W) in pixels towards the viewer.
        mask: (H, W), the object, not empty.
        faces: triangles at most; but at least those of one pixel.
    """
    small, there, factor = height, mask, 1.0
    while _closed_faces(there) > faces and min(there.shape) > 1:
        factor *= min(float(np.sqrt(faces / _closed_faces(there))), 0.97)
        shape = max(round(mask.shape[0] * factor), 1), max(round(mask.shape[1] * factor), 1)
        share = resize(mask.astype(np.float32), shape)
        total = resize(np.where(mask, height, np.float32(0)), shape)  # off the object there is no height
        there = share > min(0.5, float(share.max()) / 2)
        small = np.where(there, total / np.maximum(share, 1e-6), 0).astype(np.float32) * np.float32(factor)
    return small, there


def _closed_faces(mask: NDArray[np.bool_]) -> int:
    """Return how many triangles the relief of a mask has: two a pixel before and behind, two at each edge."""
    around = np.pad(mask, 1)
    edges = sum(int((around & ~np.roll(around, step, axis)).sum()) for step in (1, -1) for axis in (0, 1))
    return 4 * int(mask.sum()) + 2 * edges


def check_relief_path(path: str | Path) -> Path:
    """Return the path of a relief.

    Raises:
        InputError: if its suffix is neither ``.glb`` nor ``.obj``.
    """
    if Path(path).suffix.lower() not in SUFFIXES:
        raise InputError(f"the relief {path} is to be a .glb or an .obj.")
    return Path(path)


def _close(front: NDArray[np.float64], corners: Corners, floor: float) -> tuple[Any, Any]:
    """Return vertices and faces of the front with sides and a flat back at z = ``floor``."""
    back = front.copy()
    back[:, 2] = floor
    n, (start, end) = len(front), corners.rim.T
    # The rim runs with the object on its left, as its front faces have it; a side shares that edge reversed.
    sides = np.concatenate(
        [np.column_stack([end, start, start + n]), np.column_stack([end, start + n, end + n])]
    )
    faces = np.concatenate([corners.faces, corners.faces[:, ::-1] + n, sides])
    return np.concatenate([front, back]), faces


def _plate(size: NDArray[np.float64], floor: float, thickness: float) -> tuple[Any, Any]:
    """Return a box behind the whole picture, into which the relief reaches by half its thickness."""
    import trimesh

    box = trimesh.creation.box((*size, thickness))
    box.apply_translation((0, 0, floor))
    return np.asarray(box.vertices), np.asarray(box.faces)


def _join(vertices: Any, faces: Any, more: Any, others: Any) -> tuple[Any, Any]:
    return np.concatenate([vertices, more]), np.concatenate([faces, others + len(vertices)])
