"""Poses: drawn by number, within what animations show, and nothing is left behind."""

from pathlib import Path

import numpy as np
import pytest
from mesh_shapes import BALL, MESHES, needs_meshes, solid
from rig_files import RINGS, Gltf, bar, tube, write_glb, write_gltf

from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.rendering.gltf.scene import world_matrices
from normalgan.rendering.mesh_files import MeshFile, find_meshes
from normalgan.rendering.rigs import RiggedFile, find_poses
from normalgan.rendering.rigs.joints import DEFAULT_ROTATION, find_joints
from normalgan.rendering.rigs.posing import draw_pose, turned
from normalgan.rendering.rigs.reading import read_rig
from normalgan.rendering.rigs.rig import Rig, posed_surface


def limping() -> Gltf:
    """A bar on two bones, its upper quarter on a third that hangs on nothing, as feet do in rigs for
    inverse kinematics."""
    gltf, primitive = bar()
    height = tube()[0][:, 1]
    bound = np.zeros((4 * RINGS, 4), dtype=np.uint8)
    bound[:, 0] = np.where(height > 1.51, 2, np.where(height > 1.01, 1, 0))
    share = np.zeros((4 * RINGS, 4), dtype=np.float32)
    share[:, 0] = 1
    primitive["attributes"] |= {"JOINTS_0": gltf.accessor(bound), "WEIGHTS_0": gltf.accessor(share)}
    inverse = np.broadcast_to(np.eye(4), (3, 4, 4)).astype(np.float32).copy()
    inverse[1, 1, 3], inverse[2, 1, 3] = -1.0, -1.5
    gltf.tree["skins"] = [{"joints": [0, 1, 3], "inverseBindMatrices": gltf.accessor(inverse)}]
    gltf.tree["nodes"].append({"translation": [0, 1.5, 0]})
    return gltf


def longest_edge(vertices: Doubles) -> float:
    faces = tube()[1]
    return float(np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=-1).max())


def test_ranges_are_those_of_the_animations(tmp_path: Path) -> None:
    joints = find_joints(read_rig(write_gltf(tmp_path / "bar.gltf", bar()[0])))
    assert (joints.nodes.tolist(), joints.parents.tolist()) == ([0, 1], [-1, 0])
    assert not joints.low.any()
    assert not joints.high[0].any()
    # 90°, but for the twentieth at either end.
    np.testing.assert_allclose(np.rad2deg(joints.high[1]), [0, 0, 0.95 * 90], atol=0.2)


def test_without_animations_joints_turn_a_little_and_the_root_not(tmp_path: Path) -> None:
    rig = read_rig(write_gltf(tmp_path / "bar.gltf", bar(clips=False)[0]))
    joints = find_joints(rig)
    np.testing.assert_array_equal(joints.high, [[0] * 3, [DEFAULT_ROTATION] * 3])
    np.testing.assert_array_equal(joints.low, -joints.high)
    rest = tube()[0]
    for seed in range(5):
        vertices, _ = posed_surface(rig, draw_pose(rig, np.random.default_rng(seed)))
        np.testing.assert_allclose(vertices[: 4 * 11], rest[: 4 * 11], atol=1e-6)
        tip = vertices[-4:].mean(axis=0) - [0, 1, 0]
        assert 0.001 < np.arccos(tip[1] / np.linalg.norm(tip)) < np.sqrt(3) * DEFAULT_ROTATION


def test_turning_a_joint_takes_along_what_hangs_on_it(tmp_path: Path) -> None:
    rig = read_rig(write_gltf(tmp_path / "limping.gltf", limping()))
    joints = find_joints(rig)
    assert joints.nodes.tolist() == [0, 1, 3]
    assert joints.parents.tolist() == [-1, 0, 1]
    assert not joints.high[2].any()
    turns = np.array([[0, 0, 0], [0, 0, np.pi / 2], [0, 0, 0]])
    world = world_matrices(rig.nodes)
    vertices, _ = posed_surface(rig, turned(world, joints, turns))
    np.testing.assert_allclose(vertices[-4:].mean(axis=0), [-1, 1, 0], atol=1e-6)
    assert longest_edge(vertices) < 0.5
    # Left where the file has it, the foot would be torn off.
    world[1, :3, :3] = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert longest_edge(posed_surface(rig, world)[0]) > 0.7


def test_a_part_scaled_to_nothing_does_not_stop_a_pose(tmp_path: Path) -> None:
    gltf = limping()
    gltf.tree["nodes"][1]["scale"] = [0, 0, 0]
    mesh = [RiggedFile(MeshFile(str(write_gltf(tmp_path / "a.gltf", gltf))), n).load() for n in range(4)]
    assert all(np.isfinite(one.vertices).all() for one in mesh)


def test_a_pose_is_drawn_by_its_number(tmp_path: Path) -> None:
    file = MeshFile(str(write_glb(tmp_path / "bar.glb", bar()[0])))
    poses = [RiggedFile(file, number) for number in range(6)]
    meshes = [pose.load() for pose in poses]
    assert meshes[3].name == poses[3].name == "bar@3"
    np.testing.assert_array_equal(RiggedFile(file, 3).load().vertices, meshes[3].vertices)
    widths = [float(np.ptp(mesh.vertices[:, 0])) for mesh in meshes]
    assert len({round(width, 4) for width in widths}) == 6
    for mesh in meshes:
        assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(1, abs=1e-6)
        assert solid(mesh).is_watertight
        assert solid(mesh).volume > 0
    prints = {pose.fingerprint() for pose in poses} | {file.fingerprint()}
    assert len(prints) == 7
    before = poses[0].fingerprint()
    write_glb(tmp_path / "bar.glb", limping())
    assert poses[0].fingerprint() != before


def test_poses_stand_in_place_of_rigged_files_only(tmp_path: Path) -> None:
    write_glb(tmp_path / "bar.glb", bar()[0])
    BALL.export(tmp_path / "ball.glb")
    BALL.export(tmp_path / "ball2.ply")
    (tmp_path / "broken.glb").write_bytes(b"glTF")
    files = find_meshes(str(tmp_path))
    assert find_poses(files, 0) == files
    names = [source.name for source in find_poses(files, 3)]
    assert names == ["ball", "ball2", "bar@0", "bar@1", "bar@2", "broken"]
    with pytest.raises(InputError, match="poses is -2; it is the number of poses of each rigged file"):
        find_poses(files, -2)


def test_the_way_a_file_stands_holds_for_its_poses(tmp_path: Path) -> None:
    path = str(write_glb(tmp_path / "bar.glb", bar()[0]))
    upright = RiggedFile(MeshFile(path), 2).load()
    lying = RiggedFile(MeshFile(path, rotation=((0, -1, 0), (1, 0, 0), (0, 0, 1))), 2).load()
    np.testing.assert_allclose(lying.vertices[:, 0], -upright.vertices[:, 1], atol=1e-6)
    hard = RiggedFile(MeshFile(path, crease_angle=40), 2).load()
    assert len(hard.vertices) > len(upright.vertices)


def stretch(rig: Rig, world: Doubles) -> float:
    """Return the greatest growth of an edge between rest and a pose."""
    rest, faces = posed_surface(rig, world_matrices(rig.nodes))
    vertices, _ = posed_surface(rig, world)
    before, after = (
        np.linalg.norm(places[faces] - places[np.roll(faces, 1, axis=1)], axis=-1)
        for places in (rest, vertices)
    )
    size = np.ptp(rest, axis=0).max()
    return float(((after - before) / size).max())


@needs_meshes
@pytest.mark.parametrize("species", ["Horse", "Fox", "Alpaca"])
def test_feet_of_real_rigs_stay_on_their_legs(species: str) -> None:
    rig = read_rig(MESHES / "animals" / f"{species}.glb")
    joints = find_joints(rig)
    assert (joints.parents < 0).sum() == 1
    world, rng = world_matrices(rig.nodes), np.random.default_rng(1)
    for _ in range(10):
        turns = joints.low + rng.uniform(size=joints.low.shape) * (joints.high - joints.low)
        assert stretch(rig, turned(world, joints, turns)) < 0.06
