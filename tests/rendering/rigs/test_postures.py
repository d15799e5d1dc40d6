"""Postures: limbs point where the table says, feet stand on one ground, and no skin tears."""

from pathlib import Path

import numpy as np
import pytest
from mesh_shapes import MESHES, needs_meshes
from rig_files import bar, write_gltf
from test_poses import stretch

from normalgan.arrays import Doubles
from normalgan.rendering.gltf.scene import Nodes, world_matrices
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.rigs import RiggedFile
from normalgan.rendering.rigs.posing import (
    POSTURES,
    Posture,
    Skeleton,
    draw_pose,
    draw_posture,
    find_skeleton,
    in_posture,
)
from normalgan.rendering.rigs.reading import read_rig
from normalgan.rendering.rigs.rig import BoundSurface, Rig

PAWS: dict[str, tuple[str | None, tuple[float, float, float]]] = {
    "Back": (None, (0, 1, 0)),
    "Torso": ("Back", (0, 1, 0.3)),
    "Torso2": ("Torso", (0, 1, 0.6)),
    "Torso3": ("Torso2", (0, 1, 0.9)),
    "Neck1": ("Torso3", (0, 1.1, 1)),
    "Neck2": ("Neck1", (0, 1.2, 1.1)),
    "Neck3": ("Neck2", (0, 1.3, 1.2)),
    "Head": ("Neck3", (0, 1.4, 1.3)),
    "Tail1": ("Back", (0, 1, -0.2)),
    "Tail2": ("Tail1", (0, 1, -0.5)),
}
"""Parent and place at rest of the nodes of a small dog that looks to +Z."""
for letter, x in (("L", 0.2), ("R", -0.2)):
    PAWS |= {
        f"FrontUpperLeg.{letter}": ("Torso2", (x, 0.9, 0.9)),
        f"FrontLowerLeg.{letter}": (f"FrontUpperLeg.{letter}", (x, 0.6, 0.8)),
        f"IKFrontLeg.{letter}": (f"FrontLowerLeg.{letter}", (x, 0.2, 0.9)),
        f"FF.{letter}": (f"IKFrontLeg.{letter}", (x, 0, 1.0)),
        f"BackLeg.{letter}": ("Back", (x, 0.9, 0)),
        f"BackUpperLeg.{letter}": (f"BackLeg.{letter}", (x, 0.6, 0.1)),
        f"BackLowerLeg.{letter}": (f"BackUpperLeg.{letter}", (x, 0.4, -0.2)),
        f"IKBackLeg.{letter}": (f"BackLowerLeg.{letter}", (x, 0.1, -0.1)),
        f"FFB.{letter}": (f"IKBackLeg.{letter}", (x, 0, 0)),
    }


def dog(elbow: float = 0.8) -> Rig:
    """Return a rig with a stiff triangle on each node; its elbows lie at z = ``elbow``."""
    names = list(PAWS)
    places = np.array([place for _, place in PAWS.values()], dtype=np.float64)
    places[["FrontLowerLeg" in name for name in names], 2] = elbow
    parents = np.array([-1 if above is None else names.index(above) for above, _ in PAWS.values()])
    local = places - np.where(parents[:, None] >= 0, places[parents], 0)
    count = len(names)
    still = np.tile([0.0, 0, 0, 1], (count, 1))
    nodes = Nodes(parents, np.arange(count), local, still, np.ones((count, 3)), {})
    triangle = np.array([[0, 0, 0], [0.05, 0, 0], [0, 0.05, 0]])
    none = np.zeros((3, 0))
    pieces = tuple(
        BoundSurface(triangle, np.array([[0, 1, 2]]), node, None, none.astype(np.int64), none)
        for node in range(count)
    )
    return Rig(nodes, pieces, (), tuple(names))


def skeleton_of(rig: Rig) -> Skeleton:
    found = find_skeleton(rig)
    assert found is not None
    return found


def place_of(rig: Rig, world: Doubles, name: str) -> Doubles:
    return np.asarray(world[rig.names.index(name), :3, 3])


def test_limbs_point_where_the_posture_says() -> None:
    rig = dog()
    hind = ((90.0, 0.0), (-30.0, 0.0), (0.0, 20.0))
    world = in_posture(rig, skeleton_of(rig), Posture(hind=(hind, ())))
    at = {name: place_of(rig, world, name) for name in rig.names}
    rest = {name: place_of(rig, world_matrices(rig.nodes), name) for name in rig.names}
    np.testing.assert_allclose(at["BackUpperLeg.R"] - at["BackLeg.R"], [0, 0, np.hypot(0.3, 0.1)], atol=1e-9)
    shank = at["BackLowerLeg.R"] - at["BackUpperLeg.R"]
    np.testing.assert_allclose(np.rad2deg(np.arctan2(shank[2], -shank[1])), -30)
    foot = at["IKBackLeg.R"] - at["BackLowerLeg.R"]
    np.testing.assert_allclose(np.rad2deg(np.arcsin(-foot[0] / np.linalg.norm(foot))), 20)  # to the right
    for name in ("BackLowerLeg.L", "FFB.L", "Head", "FF.R"):
        np.testing.assert_allclose(at[name], rest[name], atol=1e-9)


def test_neck_turns_left_and_tail_rises() -> None:
    rig = dog()
    world = in_posture(rig, skeleton_of(rig), Posture(neck=(0, 90, 0), tail=(60, 0, 0)))
    assert place_of(rig, world, "Head")[0] > 0.05
    assert place_of(rig, world, "Tail2")[1] > 1.1
    raised = in_posture(rig, skeleton_of(rig), Posture(pitch=50))
    assert place_of(rig, raised, "Neck1")[1] > 1.7


def test_feet_of_a_level_posture_stand_on_one_ground() -> None:
    rig = dog()
    skeleton = skeleton_of(rig)
    for name, posture in POSTURES["paws"].items():
        world = in_posture(rig, skeleton, posture)
        gap = abs(place_of(rig, world, "FF.L")[1] - place_of(rig, world, "FFB.L")[1])
        assert gap < 0.02 or not posture.level, name
    assert sum(posture.level for posture in POSTURES["paws"].values()) >= 3


def test_forelegs_with_knees_are_those_of_hoofed_animals() -> None:
    assert skeleton_of(dog()).kind == "paws"
    assert skeleton_of(dog(elbow=1.0)).kind == "hooves"


def test_a_rig_of_other_names_has_no_postures() -> None:
    rig = dog()
    other = Rig(rig.nodes, rig.pieces, rig.clips, tuple(f"bone {n}" for n in range(len(rig.names))))
    assert find_skeleton(other) is None
    poses = [draw_pose(other, np.random.default_rng(3), share) for share in (0.0, 1.0)]
    assert poses[1].shape == poses[0].shape  # drawn from the joints' ranges instead


def test_nodes_have_the_names_of_the_file(tmp_path: Path) -> None:
    gltf, _ = bar()
    gltf.tree["nodes"][1]["name"] = "Tail1"
    names = read_rig(write_gltf(tmp_path / "bar.gltf", gltf)).names
    assert names == tuple("Tail1" if index == 1 else "" for index in range(len(gltf.tree["nodes"])))


def test_without_postures_poses_are_as_before() -> None:
    rig = dog()
    before, same = (draw_pose(rig, np.random.default_rng(7), *share) for share in ((), (0.0,)))
    np.testing.assert_array_equal(before, same)
    assert np.abs(draw_pose(rig, np.random.default_rng(7), 1.0) - before).max() > 0.2
    file = MeshFile("a.glb")
    assert RiggedFile(file, 1) == RiggedFile(file, 1, 0.0)


@pytest.mark.parametrize("kind", POSTURES)
def test_postures_are_drawn_about_the_table_and_mirrored(kind: str) -> None:
    drawn = [draw_posture(kind, np.random.default_rng(seed)) for seed in range(200)]
    assert drawn[5] == draw_posture(kind, np.random.default_rng(5))
    turns = [posture.spine[1] for posture in drawn]
    assert min(turns) < -15
    assert max(turns) > 15
    assert len({posture.pitch for posture in drawn}) == 200


@needs_meshes
@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("animals/Fox.glb", "paws"),
        ("animals/Horse.glb", "hooves"),
        ("rigs/modular_women__Casual.glb", "people"),
        ("rigs/single_knight__KnightCharacter.glb", "people"),
    ],
)
def test_no_skin_tears_on_real_rigs(path: str, kind: str) -> None:
    rig = read_rig(MESHES / path)
    skeleton = skeleton_of(rig)
    assert skeleton.kind == kind
    rng = np.random.default_rng(0)
    for _ in range(25):
        assert stretch(rig, in_posture(rig, skeleton, draw_posture(kind, rng))) < 0.1
    assert find_skeleton(read_rig(MESHES / "rigs/fish__Dolphin.glb")) is None
