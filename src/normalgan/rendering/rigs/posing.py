"""Poses drawn at random: a posture, a moment of an animation, or joints turned within their ranges."""

import numpy as np
from scipy.spatial.transform import Rotation

from normalgan.arrays import Doubles
from normalgan.rendering.gltf.nodes import world_matrices
from normalgan.rendering.rigs.animations import pose_at
from normalgan.rendering.rigs.joints import Joints, find_joints
from normalgan.rendering.rigs.postures import draw_posture, find_skeleton, in_posture
from normalgan.rendering.rigs.rig import Rig

__all__ = ["draw_pose", "turned"]


def draw_pose(rig: Rig, rng: np.random.Generator, postures: float = 0.0) -> Doubles:
    """Return the nodes' matrices (N, 4, 4) in a random pose.

    Half of the poses that are not postures are a moment of an animation. The others, and all of a rig
    without animations, start from rest and turn each joint by a rotation vector drawn from its range, its
    middle more likely.

    Args:
        rig: what is posed.
        rng: draws the pose.
        postures: share of the poses that are postures, if the rig's skeleton is a known one.
    """
    # At 0 nothing is drawn, so that postures do not change the other poses.
    if postures and rng.random() < postures and (skeleton := find_skeleton(rig)) is not None:
        return in_posture(rig, skeleton, draw_posture(skeleton.kind, rng))
    if rig.clips and rng.random() < 0.5:
        clip = rig.clips[rng.integers(len(rig.clips))]
        return world_matrices(pose_at(rig.nodes, clip, rng.uniform(*clip.span)))
    joints = find_joints(rig)
    share = rng.beta(2.0, 2.0, joints.low.shape)
    return turned(world_matrices(rig.nodes), joints, joints.low + share * (joints.high - joints.low))


def turned(world: Doubles, joints: Joints, turns: Doubles) -> Doubles:
    """Return the positions of the nodes after turning joints, which carry their children along.

    Args:
        world: (N, 4, 4) places of the nodes.
        joints: the joints that turn, and the parent of each node.
        turns: (J, 3) rotation vectors in the joints' own axes, in radians.
    """
    moved = world.copy()
    rotations = Rotation.from_rotvec(turns).as_matrix()
    for node, parent, rotation in zip(joints.nodes, joints.parents, rotations, strict=True):
        place = world[node]
        if parent >= 0:
            above = joints.nodes[parent]
            # The pseudo-inverse, because rigs hide parts by scaling them to 0.
            place = moved[above] @ np.linalg.pinv(world[above]) @ place
        moved[node] = place
        moved[node, :3, :3] = place[:3, :3] @ rotation
    return moved
