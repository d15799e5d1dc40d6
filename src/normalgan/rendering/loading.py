"""Read the triangles of a mesh file in any format of trimesh; scenes are flattened, nothing is repaired."""

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError, brief
from normalgan.rendering.gltf import read_gltf
from normalgan.rendering.mesh_bytes import mesh_bytes
from normalgan.rendering.mesh_limits import buffer_file, check_limits
from normalgan.warning_filters import quiet_loggers

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh

__all__ = ["SUFFIXES", "WITH_MATERIALS", "Triangles", "read_triangles"]

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]

SUFFIXES = (".off", ".obj", ".ply", ".stl", ".glb", ".gltf")
"""The file formats taken, by suffix; upper case is as good."""
WITH_MATERIALS = {".glb", ".gltf", ".obj", ".ply"}


def read_triangles(path: Path) -> Triangles:
    """Return the vertices (V, 3) and faces (F, 3) of all meshes in a file, in the file's world axes.

    Raises:
        InputError: if the file cannot be read, has no triangle, or has a coordinate that is not finite.
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
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(f"{path} has a face that refers to a vertex that is not there; is it truncated?")
    return vertices, faces


def _parts(path: Path) -> list[Triangles]:
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path} is no mesh file; its name must end in one of {' '.join(SUFFIXES)}.")
    if not path.is_file():
        raise InputError(f"{path} does not exist or is not a file; name a mesh file.")
    import trimesh  # takes a second: only when a mesh is read

    try:
        with _silence():
            check_limits(path)
            suffix = path.suffix.lower()
            # Materials are pictures: nothing that is rendered, and files of anyone's choice.
            more: dict[str, Any] = {"skip_materials": True} if suffix in WITH_MATERIALS else {}
            scene = trimesh.load_scene(
                BytesIO(_geometry(suffix, mesh_bytes(path))),
                file_type=suffix[1:],
                resolver=_linked(path),
                process=False,
                **more,
            )
            return [_placed(mesh, matrix) for mesh, matrix in _meshes(scene)]
    except InputError:
        raise
    except Exception as error:  # whatever the many parsers raise on a broken file
        raise InputError(
            f"{path} cannot be read as a mesh: {type(error).__name__}: {brief(error)}"
        ) from error


def _linked(path: Path) -> dict[str, bytes]:
    """Return what trimesh gets of the files that a mesh file refers to: buffers of a .gltf, by URI."""
    if path.suffix.lower() != ".gltf":
        return {}
    uris = [buffer.get("uri", "") for buffer in read_gltf(path)[0].get("buffers", [])]
    return {uri: mesh_bytes(buffer_file(path, uri)) for uri in uris if uri and not uri.startswith("data:")}


def _geometry(suffix: str, data: bytes) -> bytes:
    """Return what of a file trimesh is to parse: of OBJ, the lines of vertices and faces.

    It would make a mesh of each material, at milliseconds each, and read a library of materials wherever it
    is said to lie. Bytes that are no ASCII it would hand to a guesser of encodings, which takes its time.
    """
    if suffix not in {".obj", ".off"}:
        return data
    text = data.decode("ascii", "replace")
    if suffix == ".obj":
        text = text.strip().replace("\r\n", "\n").replace("\\\n", "")
        text = re.sub(r"^(?![vf])[^\n]*\n?", "", text, flags=re.MULTILINE)
    return text.encode()


def _meshes(scene: "Scene") -> Iterator[tuple["Trimesh", NDArray[np.float64]]]:
    """Yield each mesh of the scene with its (4, 4) place; points and paths are passed over."""
    import trimesh

    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        geometry = scene.geometry[name]
        if isinstance(geometry, trimesh.Trimesh):
            yield geometry, np.asarray(matrix, dtype=np.float64)


def _placed(mesh: "Trimesh", matrix: NDArray[np.float64]) -> Triangles:
    if mesh.vertices.shape[1:] != (3,):
        raise ValueError("its vertices do not have three coordinates each")
    with np.errstate(invalid="ignore"):  # coordinates that are no numbers are refused later
        vertices = np.asarray(mesh.vertices, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    faces = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
    # A mirroring transform turns what was outside inside.
    return vertices, faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces


@contextmanager
def _silence() -> Iterator[None]:
    """Keep what trimesh and the parsers under it warn and log out of the user's sight."""
    loggers = quiet_loggers("trimesh", "charset_normalizer", "chardet")
    with loggers, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield
