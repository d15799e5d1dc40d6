import os
import sys
from pathlib import Path

import pytest
from attacked_meshes import attacks, rigged
from hostile import write
from limited import SECONDS, Answer, read_limited

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")

REFUSED = {
    "stride of 0.gltf": "has elements of 12 bytes 0 bytes apart, in accessor 0",
    "many numbers.gltf": "announces 3000000043 numbers, more than a mesh file can hold",
    "many views.gltf": "refers to the same bytes again and again",
    "a part repeated.gltf": "places 200000000 vertices; reduce it to",
    "a pipe.gltf": "refers to 'pipe', which is no file",
    "a device.gltf": "refers to 'zero.bin', which is no file",
}
"""What is said of some."""
REFUSED_RIGS = {
    "many clips.gltf": "it has 50000 animations of 50000 channels; delete most of them",
    "many channels.gltf": "it has 1 animations of 50000 channels",
    "clips of many nodes.gltf": "it has 1000 animations of 1000 channels",
    "a thousand parts.gltf": "its 240000 vertices hang on 1000 loose trees of nodes; join them",
    "many sets.gltf": "a vertex is bound to 4000 joints; 16 are enough",
}
"""The same of rigs."""


def answers(folder: Path, reader: str, suffixes: set[str]) -> dict[str, Answer]:
    """Have attacked files and a sound one read in one process, within the limits; return answers by name."""
    os.mkfifo(folder / "pipe")
    chosen = {name: (content, "") for name, content in attacks().items() if Path(name).suffix in suffixes}
    chosen["sound.gltf"] = (rigged(lambda tree: None), "")
    found = {answer.name: answer for answer in read_limited(reader, write(folder, chosen))}
    for answer in found.values():
        assert answer.outcome in {"read", "refused"}, answer
        assert answer.seconds < SECONDS
        assert "\n" not in answer.words
        assert len(answer.words) < 400
    assert found["sound.gltf"].outcome == "read", found["sound.gltf"]  # else attacks on it would show nothing
    return found


def test_an_attacked_mesh_is_read_or_refused(tmp_path: Path) -> None:
    found = answers(tmp_path, "mesh", {".obj", ".ply", ".off", ".gltf"})
    for name, words in REFUSED.items():
        assert words in found[name].words, found[name]
    # What these refer to is not needed.
    for name in ("material.obj", "libraries.obj", "library 0.obj", "library 2.obj"):
        assert found[name].outcome == "read", found[name]


def test_an_attacked_rig_is_read_or_refused(tmp_path: Path) -> None:
    found = answers(tmp_path, "rig", {".gltf"})
    for name, words in (REFUSED | REFUSED_RIGS).items():
        assert words in found[name].words, found[name]
