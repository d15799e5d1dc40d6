import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_shapes import BALL, angles, solid, trimesh, write

from normalgan.errors import InputError
from normalgan.rendering.loading import SUFFIXES, read_triangles
from normalgan.rendering.mesh import MeshSource
from normalgan.rendering.mesh_files import MeshFile, find_meshes, place


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format_gives_the_same_mesh(tmp_path: Path, suffix: str) -> None:
    source: MeshSource
    egg: Any = trimesh.Trimesh(BALL.vertices * [2, 1, 1] * 30 + [5, 6, 7], BALL.faces, process=False)
    if suffix == ".gltf":  # written as several files
        for name, content in trimesh.exchange.gltf.export_gltf(egg.scene()).items():
            (tmp_path / name.replace("model", "egg")).write_bytes(content)
    else:
        egg.export(tmp_path / f"egg{suffix}")
    (source,) = find_meshes(str(tmp_path))
    mesh = source.load()
    assert (mesh.name, len(mesh.vertices), len(mesh.faces)) == ("egg", 642, 1280)
    assert (mesh.vertices.dtype, mesh.faces.dtype) == (np.dtype("float32"), np.dtype("int32"))
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [2, 1, 1], rtol=1e-3)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), -mesh.vertices.max(axis=0), atol=1e-6)
    assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(1)
    assert solid(mesh).volume == pytest.approx(BALL.volume / 4, rel=1e-3)
    assert angles(mesh.normals, mesh.vertices * [0.25, 1, 1]).max() < 3
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-300, 1e-9, 1.0, 1e9, 1e307])
def test_size_and_place_in_the_file_do_not_matter(tmp_path: Path, scale: float) -> None:
    mesh = write(tmp_path / "ball.off", (BALL.vertices + np.array([3, 0, 0])) * scale, BALL.faces).load()
    assert len(mesh.vertices) == len(BALL.vertices)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=1e-4)
    assert angles(mesh.normals, mesh.vertices).max() < 1


def test_a_mesh_is_led_back_to_where_it_lies_in_its_file() -> None:
    turned = MeshFile("ball.off", rotation=((1, 0, 0), (0, 0, 1), (0, -1, 0)))
    vertices = np.asarray(BALL.vertices) * [3, 2, 1] + [5, 6, 7]
    mesh, to_file = place("ball", turned, vertices, np.asarray(BALL.faces))
    found = np.c_[mesh.vertices, np.ones(len(mesh.vertices))] @ to_file.T
    np.testing.assert_allclose(found[:, 3], 1)
    nearest = np.linalg.norm(found[:, None, :3] - vertices[None], axis=-1).min(axis=1)
    np.testing.assert_allclose(nearest, 0, atol=1e-5)


def test_parts_of_a_scene_stand_where_their_transforms_put_them(tmp_path: Path) -> None:
    scene: Any = trimesh.Scene()
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    mirror[0, 3] = -4
    scene.add_geometry(BALL, node_name="here")
    scene.add_geometry(BALL, node_name="there", transform=mirror)
    scene.export(tmp_path / "scene.glb")
    vertices, faces = read_triangles(tmp_path / "scene.glb")
    assert trimesh.Trimesh(vertices, faces).volume == pytest.approx(2 * BALL.volume)
    np.testing.assert_allclose([vertices[:, 0].min(), vertices[:, 0].max()], [-5, 1])


def cloud(path: Path) -> None:
    trimesh.PointCloud(BALL.vertices).export(path)


FLAT = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]
BAD_FILES: dict[str, tuple[Callable[[Path], Any], str]] = {
    "nan.off": (
        lambda path: write(path, [[0, 0, 0], [1, 0, 0], [0, "nan", 0]], [[0, 1, 2]]),
        "1 vertices with a coord",
    ),
    "inf.off": (
        lambda path: write(path, [[0, 0, 0], ["inf", 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        "not a finite number",
    ),
    "none.off": (lambda path: write(path, FLAT, []), "holds no faces|cannot be read"),
    "line.off": (lambda path: write(path, FLAT, [[0, 1, 2], [1, 2, 3]]), "has only faces without area"),
    "point.off": (lambda path: write(path, [[1, 1, 1]] * 3, [[0, 1, 2]]), "has only faces without area"),
    "beyond.off": (lambda path: write(path, FLAT, [[0, 1, 9]]), "refers to a missing vertex|cannot be read"),
    "cloud.ply": (cloud, "holds no faces"),
    "empty.obj": (lambda path: path.write_text(""), "holds no faces|cannot be read"),
    "words.stl": (lambda path: path.write_text("hello"), "holds no faces|cannot be read"),
    "words.glb": (lambda path: path.write_text("hello"), "cannot be read as a mesh"),
    "short.glb": (
        lambda path: path.write_bytes(BALL.export(file_type="glb")[:3000]),
        "cannot be read as a mesh",
    ),
    "short.ply": (
        lambda path: path.write_bytes(BALL.export(file_type="ply")[:3000]),
        "cannot be read|holds no faces",
    ),
    "short.stl": (
        lambda path: path.write_bytes(BALL.export(file_type="stl")[:3000]),
        "cannot be read|holds no faces",
    ),
    "short.off": (
        lambda path: path.write_text(BALL.export(file_type="off")[:3000]),
        "cannot be read|refers to",
    ),
    "missing.off": (lambda path: None, "does not exist"),
    "mesh.blend": (lambda path: path.write_text(""), "its name must end in one of .off .obj .ply"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_file_that_is_no_mesh_is_named_with_the_reason(
    tmp_path: Path, name: str, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    make, message = BAD_FILES[name]
    make(tmp_path / name)
    with pytest.raises(InputError, match=message) as caught, caplog.at_level(logging.DEBUG):
        MeshFile(str(tmp_path / name)).load()
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")
    assert not caplog.records
