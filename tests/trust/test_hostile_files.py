"""Every reader on sound files, on what once broke it, and on hostile files, in a process with limits."""

import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from attacked_meshes import attacked_meshes, attacked_rigs
from hostile import CONFIGURATIONS, MESHES, ORIENTATIONS, PLANS, TRIANGLE, gltf
from hypothesis import given, settings
from hypothesis import strategies as st
from limited import SECONDS, read_limited
from readers import READERS
from sound_files import sound

from normalgan.errors import InputError
from normalgan.files.limits import MOST_BYTES, MOST_NODES, yaml_limit_error
from normalgan.rendering.mesh_files import MeshFile

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")

CORPUS = Path(__file__).with_name("corpus")
"""Files that broke a reader once, cut down, by reader; made for these tests, CC0."""
Files = Mapping[str, tuple[str | bytes, str | None]]
HOSTILE: dict[str, Callable[[], Files]] = {
    **dict.fromkeys(sound(), dict),
    "mesh": lambda: {**MESHES, **attacked_meshes()},
    "rig": attacked_rigs,
    "configuration": lambda: CONFIGURATIONS,
    "plan": lambda: PLANS,
    "orientation": lambda: ORIENTATIONS,
}
"""Hostile files by reader and name, and a part of the sentence that refuses each.

It is empty if the file is to be read, None if it may be read or refused.
"""


def check_reader(folder: Path, reader: str, files: Files, memory: int | None = None) -> None:
    """Check what a reader says of files, each within the limits.

    Args:
        folder: where they are written.
        reader: one of `readers.py`.
        files: as in `HOSTILE`.
        memory: bytes that one may take.
    """
    (folder / "triangle.bin").write_bytes(TRIANGLE)
    (folder / "zero.bin").symlink_to("/dev/zero")
    os.mkfifo(folder / "pipe")
    for name, (content, _) in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    for answer in read_limited(reader, [folder / name for name in files]):
        words = files[answer.name][1]
        wanted = {None: {"read", "refused"}, "": {"read"}}.get(words, {"refused"})
        assert answer.outcome in wanted, answer
        assert (words or "") in answer.words, answer
        assert "\n" not in answer.words
        assert answer.outcome == "read" or answer.name in answer.words
        assert len(answer.words) < 400 + len(str(folder))
        assert answer.seconds < SECONDS
        assert memory is None or answer.outcome == "read" or answer.memory < memory, answer
    assert not (folder / "touched").exists()


@pytest.mark.parametrize(
    "reader",
    [pytest.param(name, marks=[pytest.mark.slow] * (name in {"mesh", "rig"})) for name in HOSTILE],  # seconds
)
def test_sound_files_are_read_and_hostile_ones_refused_in_one_sentence(tmp_path: Path, reader: str) -> None:
    good: Files = {name: (content, "") for name, content in sound()[reader].items()}
    bad: Files = {path.name: (path.read_bytes(), " ") for path in (CORPUS / reader).glob("*")}
    check_reader(tmp_path, reader, {**good, **bad, **HOSTILE[reader]()})


TEXTS = [
    (reader, name, content)
    for reader in ("configuration", "plan", "orientation", "split", "hints")
    for name, content in sound()[reader].items()
    if not name.endswith(".png")
]
"""Sound files whose readers are quick and take no more memory than they are long."""


@settings(max_examples=200)
@given(st.sampled_from(TEXTS), st.data())
def test_an_edited_text_file_is_read_or_refused_in_one_sentence(
    tmp_path_factory: pytest.TempPathFactory, file: tuple[str, str, bytes], data: st.DataObject
) -> None:
    reader, name, content = file
    for _ in range(data.draw(st.integers(1, 3))):
        start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(content))] * 2)))
        words = [b"", b"null", b"[", b"{", b"-1", b"1e999", 2 * content[start:end]]
        inside = data.draw(st.binary(max_size=4) | st.sampled_from(words))
        content = content[:start] + inside + content[end:]
    path = tmp_path_factory.getbasetemp() / f"edited-{name}"
    path.write_bytes(content)
    said = ""
    try:
        READERS[reader](path)
    except InputError as error:
        said = str(error)
    assert "\n" not in said
    assert len(said) < 400 + len(str(path))


@pytest.mark.slow  # imports torch
def test_checkpoints_are_refused_in_no_more_memory_than_they_are_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from attacked_checkpoints import attacked_checkpoints, bytes_of

    monkeypatch.chdir(tmp_path)
    files: Files = {"sound.ckpt": (bytes_of(), ""), **attacked_checkpoints()}
    check_reader(tmp_path, "checkpoint", files, memory=300 * 2**20)


@pytest.mark.parametrize("name", ["mesh.off", "mesh.ply", "mesh.stl", "mesh.obj", "mesh.glb", "mesh.gltf"])
def test_a_file_without_end_is_not_read(tmp_path: Path, name: str) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**40)  # sparse: it takes no room on the disk
    for act in (MeshFile(str(tmp_path / name)).fingerprint, MeshFile(str(tmp_path / name)).load):
        with pytest.raises(InputError, match=f"has more than {MOST_BYTES} bytes"):
            act()


def test_what_is_not_hostile_is_read(tmp_path: Path) -> None:
    # Pictures are not needed: one that lies elsewhere, as exporters leave them, does no harm.
    picture = gltf(
        images=[{"uri": "/dev/zero"}],
        textures=[{"source": 0}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    )
    files = {"good": gltf(), "few": gltf(nodes=[{"mesh": 0}] * 20), "picture": picture}
    (tmp_path / "triangle.bin").write_bytes(TRIANGLE)
    for name, content in files.items():
        (tmp_path / f"{name}.gltf").write_text(content)
        assert len(MeshFile(str(tmp_path / f"{name}.gltf")).load().faces) == 1


def test_aliases_are_counted_as_if_written_out() -> None:
    text = "a: &a [{}]\nb: [{}]\n"
    enough = text.format("1, " * 900 + "1", "*a, " * 100 + "*a")
    too_many = text.format("1, " * 900 + "1", "*a, " * 111 + "*a")
    assert yaml_limit_error(enough) is None
    assert yaml_limit_error(too_many) == f"stands for more than {MOST_NODES} values"
