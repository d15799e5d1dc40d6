"""Bad rigs: each is refused with a sentence that names the file; nothing hangs, nothing else is raised."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rig_files import RINGS, Gltf, bar, write_glb, write_gltf

from normalgan.errors import InputError
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.rigs import RiggedFile
from normalgan.rendering.rigs.reading import read_rig

COUNT = 4 * RINGS
Tree = dict[str, Any]


def weighted(value: float) -> Callable[[Gltf, Tree], None]:
    def change(gltf: Gltf, primitive: Tree) -> None:
        share = np.zeros((COUNT, 4), dtype=np.float32)
        share[:, 0] = 1.0
        share[7, 0] = value
        primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(share)

    return change


def bound_to(joint: int) -> Callable[[Gltf, Tree], None]:
    def change(gltf: Gltf, primitive: Tree) -> None:
        primitive["attributes"]["JOINTS_0"] = gltf.accessor(np.full((COUNT, 4), joint, dtype=np.uint16))

    return change


def with_matrices(values: np.ndarray[Any, Any]) -> Callable[[Gltf, Tree], None]:
    def change(gltf: Gltf, primitive: Tree) -> None:
        gltf.tree["skins"][0]["inverseBindMatrices"] = gltf.accessor(values.astype(np.float32))

    return change


def put(*path: str | int, value: Any) -> Callable[[Gltf, Tree], None]:
    def change(gltf: Gltf, primitive: Tree) -> None:
        place: Any = gltf.tree
        for step in path[:-1]:
            place = place[step]
        place[path[-1]] = value

    return change


def no_triangles(gltf: Gltf, primitive: Tree) -> None:
    primitive["mode"] = 1


def backwards(gltf: Gltf, primitive: Tree) -> None:
    gltf.tree["animations"][0]["samplers"][0]["input"] = gltf.accessor(np.array([1, 0], dtype=np.float32))


BAD: dict[str, tuple[Callable[[Gltf, Tree], None], str]] = {
    "weights sum to half": (weighted(0.5), "the weights of 1 vertices do not sum to 1, the first to 0.5"),
    "negative weight": (weighted(-1.0), "a weight is negative"),
    "joint out of range": (bound_to(2), "a vertex is bound to joint 2 of 2, counted from 0"),
    "matrix nan": (with_matrices(np.full((2, 4, 4), np.nan)), "inverse bind matrix that is not finite"),
    "matrices missing": (with_matrices(np.eye(4)[None]), "skin 0 has 1 matrices for 2 joints"),
    "joint is not a node": (
        put("skins", 0, "joints", value=[0, 9]),
        "skin 0 names a joint that is not a node",
    ),
    "negative joint": (put("skins", 0, "joints", value=[0, -1]), "skin 0 names a joint that is not a node"),
    "no joints": (put("skins", 0, "joints", value=[]), "skin 0 names a joint that is not a node"),
    "no such skin": (put("nodes", 2, "skin", value=-1), "it refers to entry -1 of its 1 skins"),
    "no such mesh": (put("nodes", 2, "mesh", value=4), "it refers to entry 4 of its 1 meshes"),
    "no such child": (put("nodes", 0, "children", value=[17]), "it refers to entry 17 of its 3 nodes"),
    "cyclic nodes": (put("nodes", 1, "children", value=[0]), "its nodes are their own ancestors"),
    "its own child": (put("nodes", 2, "children", value=[2]), "its nodes are their own ancestors"),
    "two parents": (put("nodes", 2, "children", value=[1]), "node 1 has two parents"),
    "node nan": (
        put("nodes", 1, "translation", value=[0, float("nan"), 0]),
        "a node's translation has a numb",
    ),
    "flat rotation": (
        put("nodes", 1, "rotation", value=[0, 0, 0, 0]),
        "a node's rotation is not a unit quat",
    ),
    "matrix and moved": (put("nodes", 1, "matrix", value=[1.0] * 16), "moves node 1, which is placed by a m"),
    "short matrix": (put("nodes", 1, "matrix", value=[1.0] * 9), "it does not conform to glTF 2.0."),
    "no triangles": (no_triangles, "its scene shows no triangles"),
    "empty scene": (put("scenes", 0, "nodes", value=[]), "its scene shows no triangles"),
    "times run back": (backwards, "an animation's times do not ascend"),
    "interpolation": (
        put("animations", 0, "samplers", 0, "interpolation", value="MAGIC"),
        "an animation is interpolated by 'MAGIC'",
    ),
    "view beyond": (put("bufferViews", 0, "byteOffset", value=10**6), "buffer view 0 is too short"),
    "count beyond": (put("accessors", 0, "count", value=10**5), "buffer view 0 is too short"),
    "kind": (put("accessors", 0, "type", value="VEC2"), "accessor 0 holds VEC2 of 5126 where VEC3 is needed"),
    "compressed": (
        put("extensionsRequired", value=["KHR_draco_mesh_compression"]),
        "it needs the extension KHR_draco_mesh_compression, which is not supported; export the file",
    ),
    "old": (put("asset", "version", value="1.0"), "it is glTF 1.0; export it as 2.0"),
    "not a list": (put("nodes", value=3), "it does not conform to glTF 2.0"),
}


def refusal(path: Path) -> str:
    """Return the sentence that refuses a file, and check that it is one and names the file."""
    with pytest.raises(InputError) as caught:
        RiggedFile(MeshFile(str(path)), 0).load()
    sentence = str(caught.value)
    assert str(path) in sentence
    assert "\n" not in sentence
    assert sentence.endswith(".")
    return sentence


@pytest.mark.parametrize("name", BAD)
def test_a_broken_rig_is_refused(tmp_path: Path, name: str) -> None:
    gltf, primitive = bar()
    change, reason = BAD[name]
    change(gltf, primitive)
    sentence = refusal(write_gltf(tmp_path / "bar.gltf", gltf))
    assert "cannot be read as a mesh: " in sentence
    assert reason in sentence


@pytest.mark.parametrize(
    ("uri", "reason"),
    [
        ("../bar.bin", "refers to '../bar.bin', which is not in its folder"),
        ("a/../../bar.bin", "is not in its folder"),
        ("%2e%2e/bar.bin", "is not in its folder"),
        ("/etc/hostname", "is not in its folder"),
        ("file:///etc/hostname", "is not in its folder"),
        ("https://example.org/bar.bin", "is not in its folder"),
        ("gone.bin", "its buffer 'gone.bin' is missing"),
        ("a%2fb/../../bar.bin", "its buffer 'a%2fb/../../bar.bin' is missing"),
        ("short.bin", "its buffer 0 has 3 bytes of"),
        ("data:;base64,!!!", "is not base64"),
        (None, "its buffer 0 is missing"),
    ],
)
def test_a_buffer_that_is_not_there_or_elsewhere(tmp_path: Path, uri: str | None, reason: str) -> None:
    gltf, _ = bar()
    tree = gltf.finished()
    tree["buffers"][0]["uri"] = uri
    (tmp_path / "in" / "a%2fb").mkdir(parents=True)
    (tmp_path / "bar.bin").write_bytes(gltf.data)
    (tmp_path / "in" / "short.bin").write_bytes(b"abc")
    path = tmp_path / "in" / "bar.gltf"
    path.write_text(json.dumps(tree))
    with pytest.raises(InputError, match=re.escape(reason)):
        read_rig(path)
    (tmp_path / "in" / "a b.bin").write_bytes(gltf.data)
    tree["buffers"][0]["uri"] = "a%20b.bin"
    path.write_text(json.dumps(tree))
    assert len(read_rig(path).pieces) == 1
    (tmp_path / "in" / "a b.bin").rename(tmp_path / "in" / "a%20b.bin")
    assert len(read_rig(path).pieces) == 1


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_file_cut_short_or_damaged_is_refused_or_read(tmp_path: Path, data: st.DataObject) -> None:
    path = write_glb(tmp_path / "bar.glb", bar()[0])
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(0, len(content) - 1))]
    else:
        for _ in range(3):
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    load_or_refuse(path)


JUNK_VALUES: list[Any] = [None, -1, 10**9, 1.5, "x", [], {}, [[]], True, 1e308]


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_tree_with_junk_in_it_is_refused_or_read(tmp_path: Path, data: st.DataObject) -> None:
    tree: Any = bar()[0].finished()
    place = tree
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = data.draw(st.sampled_from(keys))
        inner = place[key]
        if not (isinstance(inner, (dict, list)) and inner) or data.draw(st.integers(0, 4)) == 0:
            break
        place = inner
    place[key] = data.draw(st.sampled_from(JUNK_VALUES))
    path = tmp_path / "bar.gltf"
    path.write_text(json.dumps(tree))
    load_or_refuse(path)


def load_or_refuse(path: Path) -> None:
    try:
        mesh = RiggedFile(MeshFile(str(path)), 1).load()
    except InputError:
        refusal(path)
    else:
        assert np.isfinite(mesh.vertices).all()
