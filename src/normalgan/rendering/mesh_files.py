"""MeshFile: a mesh in a file; finding mesh files by folder, glob or list, and their orientations."""

import hashlib
import json
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.errors import InputError
from normalgan.files.globs import matches
from normalgan.files.json_files import read_json
from normalgan.files.shipped_configs import find_beside
from normalgan.ranges import Range, check_ranges
from normalgan.rendering.gltf.container import linked_buffers
from normalgan.rendering.loading import SUFFIXES, read_triangles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_bytes import mesh_bytes
from normalgan.rendering.repair import shade, weld, wind

_LOADER_VERSIONS = {".obj": 3, ".off": 2}
"""Versions in fingerprints, 1 by default; increase one if `MeshFile.load` returns different meshes."""


_Rotation = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class MeshFile:
    """A mesh in a file, a `MeshSource`.

    Args:
        path: path of a file in one of the formats of `SUFFIXES`.
        rotation: 3 × 3 matrix R, x' = R x, that makes +Y point up; None for no rotation.
        inside_out: whether the faces are wound clockwise when viewed from outside; None to detect it.
        crease_angle: angle in degrees above which edges stay sharp; None smooths all edges.
    """

    path: str
    rotation: _Rotation | None = None
    inside_out: bool | None = None
    crease_angle: Annotated[float, Range(0, 180)] | None = None

    def __post_init__(self) -> None:
        """Refuse a matrix that is not a rotation, or an angle that is out of range."""
        check_ranges(self)
        if self.rotation is not None:
            object.__setattr__(self, "rotation", _checked_rotation(self.path, self.rotation))

    @property
    def name(self) -> str:
        """The file name without extension."""
        return Path(self.path).stem

    def fingerprint(self) -> str:
        """Return a hash of the file's bytes, of the files that it refers to, and of the settings.

        Raises:
            InputError: if the file cannot be read.
        """
        version = _LOADER_VERSIONS.get(Path(self.path).suffix.lower(), 1)
        settings = [version, self.name, self.rotation, self.inside_out, self.crease_angle]
        digest = hashlib.sha256(json.dumps(settings).encode())
        for path in (Path(self.path), *linked_buffers(Path(self.path))):
            digest.update(mesh_bytes(path))
        return digest.hexdigest()

    def load(self) -> Mesh:
        """Return the mesh, welded, wound outwards, rotated, centred on its bounding box, with radius 1.

        Raises:
            InputError: if the file cannot be read or contains no surface; the message gives the reason.
        """
        return place(self.name, self, *read_triangles(Path(self.path)))[0]


def place(
    name: str, file: MeshFile, vertices: Doubles, faces: Indices, about: Doubles | None = None
) -> tuple[Mesh, Doubles]:
    """Return the mesh of a file's triangles, and the (4, 4) matrix from it to the file's world axes.

    The settings of the file are applied. The mesh is moved and scaled so that its bounding box is centred
    on the origin and its farthest vertex has a distance of 1.

    Args:
        name: name of the mesh.
        file: source of the triangles, with its settings.
        vertices: (V, 3) positions, in the file's world axes.
        faces: (F, 3) vertex indices.
        about: (K, 3) points that determine centre and scale instead of the mesh's own vertices, such as
            those of all frames of an animation, in the axes of ``vertices``.

    Raises:
        InputError: if no face has a nonzero area.
    """
    # Scaled by a power of two, which is exact, because squares of huge or tiny lengths would over- or
    # underflow.
    _, exponent = np.frexp(np.abs(vertices[np.unique(faces)]).max(initial=0))
    about = None if about is None else np.ldexp(about, -exponent)
    vertices, faces = weld(np.ldexp(vertices, -exponent), faces)
    if not len(faces):
        raise InputError(f"{file.path} has only faces without area; a mesh needs triangles that have one.")
    if file.rotation is not None:
        vertices = vertices @ np.array(file.rotation).T
        about = None if about is None else about @ np.array(file.rotation).T
    about = vertices if about is None else about
    centre = (about.min(axis=0) + about.max(axis=0)) / 2
    radius = np.linalg.norm(about - centre, axis=1).max()
    vertices = (vertices - centre) / radius
    faces = wind(vertices, faces, file.inside_out)
    vertices, faces, normals = shade(vertices, faces, file.crease_angle)
    back = np.eye(3) if file.rotation is None else np.array(file.rotation).T
    to_file = np.eye(4)
    to_file[:3] = np.ldexp(back @ np.c_[radius * np.eye(3), centre], exponent)
    mesh = Mesh(name, vertices.astype(np.float32), faces.astype(np.int32), normals.astype(np.float32))
    return mesh, to_file


def find_meshes(
    source: str | list[str], orientation: str | None = None, crease_angle: float | None = None
) -> list[MeshFile]:
    """Return the mesh files given by a setting, sorted by name.

    Args:
        source: folder (without its subfolders), file, glob such as ``meshes/**/*.ply``, or a list of
            these.
        orientation: file for `read_orientations`; meshes that are not in it are not rotated.
        crease_angle: see `MeshFile`.

    Raises:
        InputError: if nothing is found, two files have the same name, or the orientation file is invalid.
    """
    sources = [source] if isinstance(source, str) else source
    paths = sorted({path for one in sources for path in _paths(one)}, key=lambda path: (path.stem, path))
    if not paths:
        raise InputError("the list of meshes is empty; name a folder, a file or a pattern.")
    for one, other in pairwise(paths):
        if one.stem == other.stem:
            raise InputError(f"two meshes are named {one.stem!r}: {one} and {other}; rename one.")
    known = {} if orientation is None else read_orientations(orientation)
    if orientation is not None and known.keys().isdisjoint(path.stem for path in paths):
        raise InputError(f"the orientation file {orientation} names none of the {len(paths)} meshes found.")
    as_it_is = _Orientation(None, None)
    return [MeshFile(str(path), *known.get(path.stem, as_it_is), crease_angle) for path in paths]


def _paths(source: str) -> list[Path]:
    """Return the mesh files of one folder, file or glob."""
    if not source:
        raise InputError("a mesh has an empty name; name a file or a folder, such as '.'.")
    place = Path(source).expanduser()
    if place.is_file():
        return [place]
    where = place.iterdir() if place.is_dir() else matches(str(place))
    # On foreign file systems, macOS writes a file ._NAME next to each file.
    found = [
        path
        for path in where
        if path.suffix.lower() in SUFFIXES and path.is_file() and not path.name.startswith("._")
    ]
    if found:
        return found
    if place.is_dir():
        raise InputError(f"the folder {source} has no mesh; files in {' '.join(SUFFIXES)} are taken.")
    raise InputError(f"{source} is not a file, a folder or a pattern that matches a mesh file.")


class _Orientation(NamedTuple):
    """The orientation of one mesh; see `MeshFile`."""

    rotation: _Rotation | None
    inside_out: bool | None


def read_orientations(path: str) -> dict[str, _Orientation]:
    """Return the orientations of a JSON file ``{"name": {"rotation": 3×3, "inside_out": bool}}``.

    Without a rotation, the mesh is not rotated. Without ``inside_out``, its outside is detected.

    Raises:
        InputError: if the file cannot be read or has another form, or a matrix is not a rotation.
    """
    table = read_json(find_beside(path), "the orientation file")
    if not isinstance(table, dict):
        raise InputError(f"the orientation file {path} must hold an object with one entry per mesh.")
    return {name: _orientation(f"{path}, mesh {name!r}", entry) for name, entry in table.items()}


def _orientation(where: str, entry: Any) -> _Orientation:
    if not isinstance(entry, dict) or not entry.keys() <= {"rotation", "inside_out"}:
        raise InputError(
            f"{where}: an orientation has 'rotation' and 'inside_out', and nothing else; "
            f"here it is {str(entry)[:60]}."
        )
    inside_out = entry.get("inside_out")
    if not isinstance(inside_out, bool | None):
        raise InputError(f"{where}: 'inside_out' is {inside_out!r}; it must be true or false.")
    rotation = entry.get("rotation")
    return _Orientation(None if rotation is None else _checked_rotation(where, rotation), inside_out)


def _checked_rotation(where: str, rows: Any) -> _Rotation:
    """Return the rotation nearest to a matrix that is a rotation except for rounding.

    Args:
        where: name of the mesh or folder, for the message.
        rows: 3 rows of 3 numbers.

    Raises:
        InputError: if ``rows`` is not a 3 × 3 matrix, or the matrix mirrors, scales or shears.

    Example:
        >>> _checked_rotation("example", [[0, -1, 0], [1, 0, 0], [0, 0, 1]])[0]
        (0.0, -1.0, 0.0)
    """
    try:
        matrix = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError(f"{where}: 'rotation' must be 3 rows of 3 numbers, x' = R x.")
    # Files round to a few digits; an error above a thousandth is not due to rounding.
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-3 or np.linalg.det(matrix) < 0:
        raise InputError(
            f"{where}: 'rotation' is not a rotation; its rows must be orthonormal, its determinant 1."
        )
    left, _, right = np.linalg.svd(matrix)
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in left @ right + 0.0)
    return x, y, z
