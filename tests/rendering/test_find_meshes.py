import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_shapes import BALL, solid, trimesh, write
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.rendering.mesh_files import MeshFile, find_meshes, read_orientations

QUARTER_TURN = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def test_a_user_may_name_a_folder_a_pattern_a_file_or_several(tmp_path: Path) -> None:
    for name in ("b/10.off", "b/9.PLY", "b/notes.txt", "c/cow.glb"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()

    def names(source: str | list[str]) -> list[str]:
        return [mesh.name for mesh in find_meshes(source)]

    folder = str(tmp_path / "b")
    assert names(folder) == ["10", "9"]
    assert names(str(tmp_path / "*" / "*")) == ["10", "9", "cow"]
    assert names(str(tmp_path / "**" / "*.glb")) == ["cow"]
    assert names([str(tmp_path / "c" / "cow.glb"), folder, str(tmp_path / "b" / "10.off")]) == [
        "10",
        "9",
        "cow",
    ]


def test_sources_that_hold_no_mesh_or_two_of_one_name_are_refused(tmp_path: Path) -> None:
    sources: list[tuple[str | list[str], str]] = [
        (str(tmp_path), "the folder .* has no mesh; files in .off .obj"),
        ("", "a mesh has an empty name; name a file or a folder"),
        (str(tmp_path / "gone"), "gone is not a file, a folder or a pattern that matches"),
        (str(tmp_path / "*.off"), "a pattern that matches a mesh file"),
        ([], "the list of meshes is empty"),
    ]
    for source, message in sources:
        with pytest.raises(InputError, match=message):
            find_meshes(source)
    (tmp_path / "cow.off").touch()
    (tmp_path / "cow.ply").touch()
    with pytest.raises(InputError, match=r"two meshes are named 'cow': .*cow.off and .*cow.ply; rename one"):
        find_meshes(str(tmp_path))


def test_the_fingerprint_follows_content_and_settings_but_not_the_place(tmp_path: Path) -> None:
    one = write(tmp_path / "ball.off", BALL.vertices, BALL.faces)
    (tmp_path / "copy").mkdir()
    shutil.copy(one.path, tmp_path / "copy" / "ball.off")
    assert MeshFile(str(tmp_path / "copy" / "ball.off")).fingerprint() == one.fingerprint()
    variants = [
        one,
        write(tmp_path / "other.off", BALL.vertices, BALL.faces),
        MeshFile(one.path, rotation=QUARTER_TURN),
        MeshFile(one.path, inside_out=True),
        MeshFile(one.path, inside_out=False),
        MeshFile(one.path, crease_angle=30),
    ]
    prints = {mesh.fingerprint() for mesh in variants}
    assert len(prints) == len(variants)
    write(tmp_path / "ball.off", BALL.vertices * 2, BALL.faces)
    assert one.fingerprint() not in prints
    with pytest.raises(InputError, match=r"gone.off cannot be read"):
        MeshFile(str(tmp_path / "gone.off")).fingerprint()


def test_the_fingerprint_of_a_gltf_covers_the_file_of_its_numbers(tmp_path: Path) -> None:
    for name, content in trimesh.exchange.gltf.export_gltf(BALL.scene()).items():
        (tmp_path / name).write_bytes(content)
    mesh = MeshFile(str(tmp_path / "model.gltf"))
    before = mesh.fingerprint()
    buffer = next(tmp_path.glob("*.bin"))
    buffer.write_bytes(buffer.read_bytes()[:-1] + b"\1")
    assert mesh.fingerprint() != before


def test_an_orientation_file_turns_the_meshes_that_it_names(tmp_path: Path) -> None:
    egg: Any = trimesh.Trimesh(BALL.vertices * [2, 1, 1], BALL.faces[:, ::-1], process=False)
    for name in ("turned", "left"):
        egg.export(tmp_path / f"{name}.off")
    table = tmp_path / "table.json"
    table.write_text(json.dumps({"turned": {"rotation": QUARTER_TURN, "inside_out": True}, "elsewhere": {}}))
    left, turned = find_meshes(str(tmp_path), str(table), crease_angle=120)
    assert left == MeshFile(str(tmp_path / "left.off"), crease_angle=120)
    assert (turned.rotation, turned.inside_out) == (QUARTER_TURN, True)
    extents: list[NDArray[np.float32]] = [np.ptp(mesh.load().vertices, axis=0) for mesh in (left, turned)]
    np.testing.assert_allclose(extents, [[2, 1, 1], [1, 2, 1]], rtol=1e-3)
    assert solid(left.load()).volume > 0 < solid(turned.load()).volume
    table.write_text('{"elsewhere": {}}')
    with pytest.raises(InputError, match="names none of the 2 meshes found"):
        find_meshes(str(tmp_path), str(table))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("[]", "must hold an object with one entry per mesh"),
        ('{"a": 3}', "mesh 'a': an orientation has 'rotation' and 'inside_out'"),
        ('{"a": {"rotate": 3}}', "and nothing else"),
        ('{"a": {"inside_out": 1}}', "'inside_out' is 1; it must be true or false"),
        ('{"a": {"rotation": [[1, 0], [0, 1]]}}', "must be 3 rows of 3 numbers"),
        ('{"a": {"rotation": [[1, 0, 0], [0, 1], [0, 0, 1]]}}', "must be 3 rows of 3 numbers"),
        ('{"a": {"rotation": [["x", 0, 0], [0, 1, 0], [0, 0, 1]]}}', "must be 3 rows of 3 numbers"),
        ('{"a": {"rotation": [[NaN, 0, 0], [0, 1, 0], [0, 0, 1]]}}', "must be 3 rows of 3 numbers"),
        ('{"a": {"rotation": [[2, 0, 0], [0, 1, 0], [0, 0, 1]]}}', "is not a rotation"),
        ('{"a": {"rotation": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]}}', "is not a rotation"),
    ],
)
def test_a_bad_orientation_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "orientation.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_orientations(str(path))
    with pytest.raises(InputError, match=r"gone\.json cannot be read"):
        read_orientations(str(tmp_path / "gone.json"))


def test_a_matrix_that_is_not_a_rotation_is_refused() -> None:
    with pytest.raises(InputError, match=r"cow.off: 'rotation' is not a rotation"):
        MeshFile("cow.off", rotation=((1, 0, 0), (0, 1, 0), (0, 0, 2)))
