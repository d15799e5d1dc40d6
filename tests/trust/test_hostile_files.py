"""Files from strangers: each is read, or refused in one sentence."""

import json
import os
import struct
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from normalgan.benchmark.plan import read_plan
from normalgan.cli.config_files import check_config
from normalgan.data.splits import split_by_file
from normalgan.errors import InputError
from normalgan.files.limits import MOST_BYTES
from normalgan.inference.reading.drawings import read_drawing
from normalgan.inference.reading.hint_files import load_hints
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.orientation import read_orientations

CORPUS = Path(__file__).with_name("corpus")
"""Drawings that broke the reader once, cut down; made for these tests, CC0."""
TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def gltf(uri: str) -> str:
    """Return a glTF file of one triangle, whose numbers lie under a URI."""
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": uri}],
            # Pictures are not needed: one that lies elsewhere, as exporters leave them, does no harm.
            "images": [{"uri": "/dev/zero"}],
            "textures": [{"source": 0}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        }
    )


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("../../etc/passwd", "which does not lie in its folder"),  # more: test_bad_rigs.py
        ("zero.bin", "which is no file"),
        ("pipe", "which is no file"),
    ],
)
def test_a_mesh_opens_no_file_outside_its_folder(tmp_path: Path, uri: str, words: str) -> None:
    (tmp_path / "triangle.bin").write_bytes(TRIANGLE)
    (tmp_path / "zero.bin").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "good.gltf").write_text(gltf("triangle.bin"))
    assert len(MeshFile(str(tmp_path / "good.gltf")).load().faces) == 1
    (tmp_path / "bad.gltf").write_text(gltf(uri))
    for act in (MeshFile(str(tmp_path / "bad.gltf")).fingerprint, MeshFile(str(tmp_path / "bad.gltf")).load):
        with pytest.raises(InputError, match=rf"bad\.gltf refers to .*, {words}"):
            act()


def test_a_file_without_end_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "mesh.off").open("wb") as file:
        file.truncate(2**40)  # sparse: it takes no room on the disk
    for act in (MeshFile(str(tmp_path / "mesh.off")).fingerprint, MeshFile(str(tmp_path / "mesh.off")).load):
        with pytest.raises(InputError, match=f"has more than {MOST_BYTES} bytes"):
            act()


@pytest.mark.parametrize("path", sorted((CORPUS / "drawing").iterdir()), ids=lambda path: path.name)
def test_a_drawing_that_broke_the_reader_is_refused(path: Path) -> None:
    with pytest.raises(InputError) as refusal:
        read_drawing(path)
    assert path.name in str(refusal.value)
    assert "\n" not in str(refusal.value)


PLAN = """\
name: A comparison
images: 42000
rows:
  - {name: mean, label: mean normal, classical: mean}
  - {name: ours, label: ours, group: ours, configs: [configs/ours.yaml], settings: {model.n_critic: 1}}
"""
TEXTS = {
    "hints.json": (json.dumps([{"x": 1.5, "y": 0, "normal": [0, 0, 1]}]), lambda p: load_hints(p, (32, 32))),
    "turned.json": (
        json.dumps({"ball": {"rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "inside_out": False}}),
        lambda p: read_orientations(str(p)),
    ),
    "split.json": (
        json.dumps({"train": ["a"], "val": ["b"], "test": ["c"]}),
        lambda p: split_by_file(p, ["a", "b", "c"]),
    ),
    "config.yaml": ("data: {size: 64, on: 2026-02-03}\nmodel: {n_critic: 5}\n", check_config),
    "plan.yaml": (PLAN, read_plan),
}


@pytest.mark.filterwarnings("ignore")  # of meshes that a split leaves out
@settings(max_examples=200)
@given(st.sampled_from(sorted(TEXTS)), st.data())
def test_an_edited_text_file_is_read_or_refused_in_one_sentence(
    tmp_path_factory: pytest.TempPathFactory, name: str, data: st.DataObject
) -> None:
    text, read = TEXTS[name]
    content = text.encode()
    for _ in range(data.draw(st.integers(1, 3))):
        start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(content))] * 2)))
        words = [b"", b"null", b"[", b"{", b"-1", b"1e999", 2 * content[start:end]]
        inside = data.draw(st.binary(max_size=4) | st.sampled_from(words))
        content = content[:start] + inside + content[end:]
    path = tmp_path_factory.getbasetemp() / f"edited-{name}"
    path.write_bytes(content)
    said = ""
    try:
        read(path)
    except InputError as error:
        said = str(error)
    assert "\n" not in said
    assert len(said) < 400 + len(str(path))
