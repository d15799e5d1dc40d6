"""Skinning: a bar on two bones bent by 90° has a known shape, however its numbers are stored."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_shapes import MESHES, needs_meshes, trimesh
from rig_files import RINGS, Gltf, bar, tube, write_glb, write_gltf

from normalgan.arrays import Doubles
from normalgan.rendering.gltf.scene import world_matrices
from normalgan.rendering.rigs.animations import pose_at
from normalgan.rendering.rigs.posing import draw_pose
from normalgan.rendering.rigs.reading import read_rig
from normalgan.rendering.rigs.rig import Rig, posed_surface


def at(rig: Rig, moment: float) -> Doubles:
    """Return the vertices (V, 3) at a moment of the first clip."""
    return posed_surface(rig, world_matrices(pose_at(rig.nodes, rig.clips[0], moment)))[0]


def bowed(degrees: float) -> Doubles:
    """Return the bar's vertices with the upper half turned about the middle, towards -x."""
    points = tube()[0].astype(np.float64)
    a = np.deg2rad(degrees)
    matrix = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    upper = points[:, 1] > 1.01
    points[upper] = (points[upper] - [0, 1, 0]) @ matrix.T + [0, 1, 0]
    return points


@pytest.mark.parametrize("weights", ["f4", "u1", "u2"])
@pytest.mark.parametrize("joints", ["u1", "u2"])
def test_a_bar_on_two_bones_bends_by_a_right_angle(tmp_path: Path, weights: str, joints: str) -> None:
    gltf, _ = bar(weights, joints)
    for path in (write_gltf(tmp_path / "bar.gltf", gltf), write_glb(tmp_path / "bar.glb", gltf)):
        rig = read_rig(path)
        np.testing.assert_allclose(at(rig, 1.0), bowed(90), atol=1e-6)
        np.testing.assert_allclose(at(rig, 1 / 3), bowed(30), atol=1e-6)  # at an even speed
        np.testing.assert_allclose(at(rig, -1.0), bowed(0), atol=1e-6)
        np.testing.assert_array_equal(posed_surface(rig, world_matrices(rig.nodes))[1], tube()[1])


def test_a_vertex_bound_to_both_bones_goes_half_way(tmp_path: Path) -> None:
    gltf, primitive = bar()
    half = np.full((4 * RINGS, 4), [0.5, 0.5, 0, 0], dtype=np.float32)
    primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(half)
    posed = at(read_rig(write_gltf(tmp_path / "bar.gltf", gltf)), 1.0)
    np.testing.assert_allclose(posed[-4:], (bowed(0) + bowed(90))[-4:] / 2, atol=1e-6)


def test_weights_that_exporters_rounded_are_brought_to_one(tmp_path: Path) -> None:
    gltf, primitive = bar()
    share = np.zeros((4 * RINGS, 4), dtype=np.float32)
    share[:, 0] = 0.97
    bound = np.zeros((4 * RINGS, 4), dtype=np.uint8)
    bound[:, 3] = 200  # any number where the weight is 0
    primitive["attributes"] |= {"WEIGHTS_0": gltf.accessor(share), "JOINTS_0": gltf.accessor(bound)}
    np.testing.assert_allclose(at(read_rig(write_gltf(tmp_path / "bar.gltf", gltf)), 1.0), tube()[0])


def test_eight_joints_a_vertex_come_in_two_sets(tmp_path: Path) -> None:
    gltf, primitive = bar()
    nothing = gltf.accessor(np.zeros((4 * RINGS, 4), dtype=np.float32))
    attributes = primitive["attributes"]
    attributes |= {"JOINTS_1": attributes["JOINTS_0"], "WEIGHTS_1": attributes["WEIGHTS_0"]}
    attributes["WEIGHTS_0"] = nothing
    np.testing.assert_allclose(
        at(read_rig(write_gltf(tmp_path / "bar.gltf", gltf)), 1.0), bowed(90), atol=1e-6
    )


def test_sparse_and_interleaved_accessors(tmp_path: Path) -> None:
    gltf, primitive = bar()
    vertices = tube()[0]
    wide = gltf.view(np.hstack([vertices, vertices]), byteStride=24)
    moved = {"count": 2, "indices": {}, "values": {}}
    places = gltf.view(np.array([0, 5], dtype=np.uint8))
    moved["indices"] = {"bufferView": places, "componentType": 5121}
    moved["values"] = {"bufferView": gltf.view(np.array([[1, 2, 3], [4, 5, 6]], dtype=np.float32))}
    entry = {"bufferView": wide, "byteOffset": 12, "componentType": 5126, "type": "VEC3"}
    gltf.tree["accessors"].append({**entry, "count": len(vertices), "sparse": moved})
    primitive["attributes"]["POSITION"] = len(gltf.tree["accessors"]) - 1
    found = read_rig(write_gltf(tmp_path / "bar.gltf", gltf)).pieces[0].vertices
    expected = vertices.copy()
    expected[[0, 5]] = [[1, 2, 3], [4, 5, 6]]
    np.testing.assert_array_equal(found, expected)


def with_hat(gltf: Gltf) -> None:
    """Put a stiff triangle on the second bone, mirrored and in a mesh of its own, and points beside it."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    primitive: dict[str, Any] = {"attributes": {"POSITION": gltf.accessor(points)}}
    gltf.tree["meshes"].append({"primitives": [primitive, {**primitive, "mode": 0}]})
    mirror = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1]  # x to -x, then up by 1
    gltf.tree["nodes"].append({"mesh": 1, "matrix": mirror})
    gltf.tree["nodes"][1]["children"] = [3]
    gltf.tree["nodes"].append({"mesh": 1})  # not in the scene


def test_stiff_surfaces_ride_on_bones(tmp_path: Path) -> None:
    gltf, _ = bar()
    with_hat(gltf)
    rig = read_rig(write_gltf(tmp_path / "bar.gltf", gltf))
    assert len(rig.pieces) == 2
    np.testing.assert_allclose(at(rig, 0.0)[-3:], [[0, 2, 0], [-1, 2, 0], [0, 3, 0]], atol=1e-6)
    np.testing.assert_allclose(at(rig, 1.0)[-3:], [[-1, 1, 0], [-1, 0, 0], [-2, 1, 0]], atol=1e-6)
    faces = posed_surface(rig, world_matrices(rig.nodes))[1]
    first = 4 * RINGS
    assert faces[-1].tolist() == [first + 2, first + 1, first]  # a mirror turns a face over


UNUSABLE = {"nan": np.nan, "infinity": np.inf, "nothing": 0.0}


@pytest.mark.parametrize("value", UNUSABLE.values(), ids=UNUSABLE)
def test_a_vertex_without_weights_moves_as_the_nearest_one_that_has_some(
    tmp_path: Path, value: float
) -> None:
    gltf, primitive = bar()
    share = np.zeros((4 * RINGS, 4), dtype=np.float32)
    share[:, 1] = tube()[0][:, 1] > 1.01
    share[:, 0] = 1 - share[:, 1]
    share[[1, -1]] = value  # one on either bone
    primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(share)
    posed = at(read_rig(write_gltf(tmp_path / "bar.gltf", gltf)), 1.0)
    np.testing.assert_allclose(posed, bowed(90), atol=1e-6)


def without_joints(gltf: Gltf, attributes: dict[str, Any]) -> None:
    del attributes["JOINTS_0"]


def all_weights(value: float) -> Callable[[Gltf, dict[str, Any]], None]:
    def change(gltf: Gltf, attributes: dict[str, Any]) -> None:
        attributes["WEIGHTS_0"] = gltf.accessor(np.full((4 * RINGS, 4), value, dtype=np.float32))

    return change


UNBOUND = {name: all_weights(value) for name, value in UNUSABLE.items()} | {"no joints": without_joints}


@pytest.mark.parametrize("unbind", UNBOUND.values(), ids=UNBOUND)
def test_a_part_without_weights_follows_its_node(
    tmp_path: Path, unbind: Callable[[Gltf, dict[str, Any]], None]
) -> None:
    gltf, primitive = bar()
    part = {**primitive, "attributes": dict(primitive["attributes"])}
    unbind(gltf, part["attributes"])
    gltf.tree["meshes"][0]["primitives"].append(part)
    rig = read_rig(write_gltf(tmp_path / "bar.gltf", gltf))
    for moment in (0.0, 1.0):
        bound, follows = np.split(at(rig, moment), 2)
        np.testing.assert_allclose(bound, bowed(90 * moment), atol=1e-6)
        np.testing.assert_allclose(follows, tube()[0] + 5.0, atol=1e-6)  # where its node is


@needs_meshes
@pytest.mark.parametrize("name", ["easy_enemies__Wasp", "modular_women__Adventurer"])
def test_rigs_of_which_parts_have_no_weights_are_posed_in_one_piece(name: str) -> None:
    rig = read_rig(MESHES / "rigs" / f"{name}.glb")
    rest, faces = posed_surface(rig, world_matrices(rig.nodes))
    corners = [faces, np.roll(faces, 1, axis=1)]
    size = np.ptp(rest, axis=0).max()
    for seed in range(4):
        posed, _ = posed_surface(rig, draw_pose(rig, np.random.default_rng(seed)))
        before, after = (np.linalg.norm(p[corners[0]] - p[corners[1]], axis=-1) for p in (rest, posed))
        assert (after - before).max() < 0.1 * size


POSES = sorted((MESHES / "animals" / "poses").glob("*.ply"))[::12]


@pytest.mark.slow
@needs_meshes
def test_poses_agree_with_those_that_somebody_else_evaluated() -> None:
    """Those files hold the moments (k + 1/2) / 3 of a clip, as they are; they interpolate straight."""
    assert len(POSES) > 20
    for path in POSES:
        species, clip_name, number = path.stem.split("__")
        rig = read_rig(MESHES / "animals" / f"{species}.glb")
        clip = next(clip for clip in rig.clips if clip.name.endswith(f"|{clip_name}"))
        start, end = clip.span
        moment = start + (int(number) + 0.5) / 3 * (end - start)
        ours, _ = posed_surface(rig, world_matrices(pose_at(rig.nodes, clip, moment)))
        theirs = trimesh.load(path, process=False)
        distance = trimesh.points.PointCloud(ours).kdtree.query(theirs.vertices)[0]
        assert distance.max() < 1.2e-3 * np.ptp(theirs.vertices, axis=0).max(), path.stem
