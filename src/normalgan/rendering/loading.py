"""Reading of triangles from mesh files: polygons are triangulated, scenes flattened, nothing is repaired."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.errors import InputError, brief
from normalgan.rendering.mesh_bytes import mesh_bytes
from normalgan.rendering.ply import read_ply
from normalgan.rendering.polygons import BrokenMeshError, read_obj, read_off
from normalgan.warning_filters import quiet_loggers

_Triangles = tuple[Doubles, Indices]

_POLYGONS = {".off": read_off, ".obj": read_obj, ".ply": read_ply}
"""Readers for formats with polygonal faces."""
SUFFIXES = (*_POLYGONS, ".stl", ".glb", ".gltf")
"""The file extensions of supported formats, in lower case."""


def read_triangles(path: Path) -> _Triangles:
    """Return the vertices (V, 3) and faces (F, 3) of all meshes in a file, in the file's world axes.

    Raises:
        InputError: if the file cannot be read, has no triangles, or has non-finite coordinates.
    """
    parts = _parts(path)
    if not any(len(faces) for _, faces in parts):
        raise InputError(f"{path} holds no faces; a mesh of triangles is needed, not points or lines.")
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = np.concatenate([faces + start for (_, faces), start in zip(parts, starts[:-1], strict=True)])
    if not np.isfinite(vertices).all():
        bad = int((~np.isfinite(vertices)).any(axis=1).sum())
        raise InputError(f"{path} has {bad} vertices with a coordinate that is not a finite number.")
    return vertices, faces


def _parts(path: Path) -> list[_Triangles]:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{path} is not a mesh file; its name must end in one of {' '.join(SUFFIXES)}.")
    if not path.is_file():
        raise InputError(f"{path} does not exist or is not a file; name a mesh file.")
    try:
        with _silence():
            if suffix in _POLYGONS:
                polygons = _POLYGONS[suffix](mesh_bytes(path))
                return [(polygons.vertices, polygons.triangles())]
            if suffix == ".stl":
                return _stl(path)
            from normalgan.rendering.gltf.scene import read_surfaces  # importing scipy takes half a second

            return read_surfaces(path)
    except InputError:
        raise
    except Exception as error:  # a parser may raise anything on a damaged file
        # Only messages for users; an IndexError describes the parser, not the file.
        said = f"it is damaged, or not of the format {suffix}"
        said = brief(error) if isinstance(error, BrokenMeshError) else said
        raise InputError(f"{path} cannot be read as a mesh: {said}.") from error


def _stl(path: Path) -> list[_Triangles]:
    import trimesh  # takes a second to import, only needed to read meshes

    mesh = trimesh.load_mesh(BytesIO(mesh_bytes(path)), file_type="stl", process=False)
    return [(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64).reshape(-1, 3))]


@contextmanager
def _silence() -> Iterator[None]:
    """Silence the warnings and log messages of trimesh and its parsers."""
    loggers = quiet_loggers("trimesh", "charset_normalizer", "chardet")
    with loggers, warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
        yield
