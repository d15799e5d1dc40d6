import sys
from pathlib import Path

import pytest
from hostile import CLUSTERS, CONFIGURATIONS, MESHES, ORIENTATIONS, PLANS, gltf, pickles, write
from limited import SECONDS, read_limited

from normalgan.errors import InputError
from normalgan.files.limits import MOST_BYTES, MOST_NODES, yaml_limit_error
from normalgan.rendering.mesh_files import MeshFile

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")


@pytest.mark.parametrize(
    ("reader", "files"),
    [
        ("mesh", MESHES),
        ("configuration", CONFIGURATIONS),
        ("orientation", ORIENTATIONS),
        ("plan", PLANS),
        ("cluster", CLUSTERS),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_hostile_files_are_refused_in_one_sentence(
    tmp_path: Path, reader: str, files: dict[str, tuple[str | bytes, str]]
) -> None:
    answers = read_limited(reader, write(tmp_path, files))
    for answer in answers:
        assert answer.outcome == "refused", answer
        assert files[answer.name][1] in answer.words, answer
        assert answer.name in answer.words
        assert "\n" not in answer.words
        assert len(answer.words) < 400
        assert answer.seconds < SECONDS
    assert not (tmp_path / "touched").exists()


@pytest.mark.parametrize("name", ["mesh.off", "mesh.ply", "mesh.stl", "mesh.obj", "mesh.glb", "mesh.gltf"])
def test_a_file_without_end_is_not_read(tmp_path: Path, name: str) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**40)  # sparse: it takes no room on the disk
    for act in (MeshFile(str(tmp_path / name)).fingerprint, MeshFile(str(tmp_path / name)).load):
        with pytest.raises(InputError, match=f"has more than {MOST_BYTES} bytes"):
            act()


def test_what_is_not_hostile_is_read(tmp_path: Path) -> None:
    write(tmp_path, {"good.gltf": (gltf(), ""), "few.gltf": (gltf(nodes=[{"mesh": 0}] * 20), "")})
    # Pictures are not needed: one that lies elsewhere, as exporters leave them, does no harm.
    picture = gltf(
        images=[{"uri": "/dev/zero"}],
        textures=[{"source": 0}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    )
    (tmp_path / "picture.gltf").write_text(picture)
    for name in ("good", "few", "picture"):
        assert len(MeshFile(str(tmp_path / f"{name}.gltf")).load().faces) == 1


def test_aliases_are_counted_as_if_written_out() -> None:
    text = "a: &a [{}]\nb: [{}]\n"
    enough = text.format("1, " * 900 + "1", "*a, " * 100 + "*a")
    too_many = text.format("1, " * 900 + "1", "*a, " * 111 + "*a")
    assert yaml_limit_error(enough) is None
    assert yaml_limit_error(too_many) == f"stands for more than {MOST_NODES} values"


@pytest.mark.slow  # imports torch
def test_a_pickle_runs_nothing(tmp_path: Path) -> None:
    touched = tmp_path / "touched"
    for answer in read_limited("checkpoint", list(pickles(tmp_path, touched))):
        assert answer.outcome == "refused", answer
        assert "is damaged or no checkpoint" in answer.words
    assert not touched.exists()
