"""Random poses: a posture, a frame of an animation, or joints rotated within their ranges.

Postures are sitting, lying, rearing and other poses of known skeletons that are rare in animations.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from normalgan.arrays import Doubles
from normalgan.rendering.gltf.scene import world_matrices
from normalgan.rendering.rigs.animations import pose_at
from normalgan.rendering.rigs.joints import Joints, find_joints, owned_vertices
from normalgan.rendering.rigs.rig import Rig


def draw_pose(rig: Rig, rng: np.random.Generator, postures: float = 0.0) -> Doubles:
    """Return the nodes' matrices (N, 4, 4) in a random pose.

    Half of the poses that are not postures are frames of an animation. The others, and all poses of a rig
    without animations, start from the rest pose and rotate each joint by a random rotation vector from its
    range, preferring the middle.

    Args:
        rig: rig to pose.
        rng: source of randomness.
        postures: fraction of the poses that are postures, if the rig's skeleton is known.
    """
    # At 0, no random number is drawn, so that the other poses stay the same.
    if postures and rng.random() < postures and (skeleton := find_skeleton(rig)) is not None:
        return in_posture(rig, skeleton, draw_posture(skeleton.kind, rng))
    if rig.clips and rng.random() < 0.5:
        clip = rig.clips[rng.integers(len(rig.clips))]
        return world_matrices(pose_at(rig.nodes, clip, rng.uniform(*clip.span)))
    joints = find_joints(rig)
    fraction = rng.beta(2.0, 2.0, joints.low.shape)
    return turned(world_matrices(rig.nodes), joints, joints.low + fraction * (joints.high - joints.low))


def turned(world: Doubles, joints: Joints, turns: Doubles) -> Doubles:
    """Return the matrices of the nodes after rotating joints together with their children.

    Args:
        world: (N, 4, 4) matrices of the nodes.
        joints: joints to rotate, with the parent of each node.
        turns: (J, 3) rotation vectors in the joints' own axes, in radians.
    """
    moved = world.copy()
    rotations = Rotation.from_rotvec(turns).as_matrix()
    for node, parent, rotation in zip(joints.nodes, joints.parents, rotations, strict=True):
        place = world[node]
        if parent >= 0:
            above = joints.nodes[parent]
            # A pseudo-inverse, because rigs hide parts by scaling them to 0.
            place = moved[above] @ np.linalg.pinv(world[above]) @ place
        moved[node] = place
        moved[node, :3, :3] = place[:3, :3] @ rotation
    return moved


_Bend = tuple[float, float, float]
"""Angles in degrees: pitch raises the front, yaw turns it to the left, and roll raises the left side."""
_Way = tuple[float, float] | None
"""Direction of a limb segment in degrees: forward from straight down, and outward; None for the rest pose."""
_Limb = tuple[_Way, ...]
"""The segments from the uppermost joint down; omitted segments follow the one above."""


@dataclass(frozen=True)
class Posture:
    """Angles of the parts of a body.

    Args:
        fore: right and left foreleg or arm.
        hind: right and left hind leg or leg.
        pitch: rotation of the trunk about the hips that raises the front, in degrees.
        spine: bend of the trunk from hips to shoulders.
        neck: bend of the neck.
        head: rotation of the head relative to the neck.
        tail: bend of the tail; its pitch raises the tip.
        whole: final rotation of the whole figure, to lay it down; random poses vary it by up to 15 %.
        spread: maximum random deviation of limb and trunk angles from the table, in degrees.
        free: maximum random deviation of neck and head angles from the table, in degrees; twice for the tail.
        level: whether the trunk is pitched so that forefeet and hind feet stand on the same level.
    """

    fore: tuple[_Limb, _Limb] = ((), ())
    hind: tuple[_Limb, _Limb] = ((), ())
    pitch: float = 0.0
    spine: _Bend = (0.0, 0.0, 0.0)
    neck: _Bend = (0.0, 0.0, 0.0)
    head: _Bend = (0.0, 0.0, 0.0)
    tail: _Bend = (0.0, 0.0, 0.0)
    whole: _Bend = (0.0, 0.0, 0.0)
    spread: float = 7.0
    free: _Bend = (20.0, 35.0, 8.0)
    level: bool = False


def _tuples(value: Any) -> Any:
    """Return a JSON value with all lists, including nested ones, as tuples."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


POSTURES: Mapping[str, Mapping[str, Posture]] = {
    kind: {
        name: Posture(**{part: _tuples(angles) for part, angles in parts.items()})
        for name, parts in postures.items()
    }
    for kind, postures in json.loads(Path(__file__).with_name("postures.json").read_bytes()).items()
}
"""The postures of each kind of body, by name. Which one `draw_posture` draws depends on their order."""


@dataclass(frozen=True)
class Skeleton:
    """The body parts of a rig as node indices.

    Args:
        kind: kind of body, a key of `POSTURES`.
        trunk: nodes from the hips to the shoulders; the first moves all others.
        neck: nodes from the shoulders up.
        head: nodes above the neck.
        tail: nodes from the root of the tail.
        fore: right and left foreleg or arm, from the uppermost joint down.
        hind: right and left hind leg or leg, likewise.
        parents: (N,) parent of each node, -1 for none.
        places: (N, 3) positions of the nodes in the rest pose, x to the body's left, y up, z ahead.
        tips: (N, 3) centre of the surface that each node moves, or its own position if it moves none.
        axes: (3, 3) columns left, up and ahead in the file's axes.
    """

    kind: str
    trunk: tuple[int, ...]
    neck: tuple[int, ...]
    head: int
    tail: tuple[int, ...]
    fore: tuple[tuple[int, ...], tuple[int, ...]]
    hind: tuple[tuple[int, ...], tuple[int, ...]]
    parents: tuple[int, ...]
    places: Doubles
    tips: Doubles
    axes: Doubles


@dataclass(frozen=True)
class _Names:
    """The names of the nodes in one family of rigs; ``{}`` stands for R or L."""

    trunk: tuple[str, ...]
    neck: tuple[str, ...]
    fore: tuple[str, ...]
    hind: tuple[str, ...]
    kind: str | None = None


_QUADRUPEDS = _Names(
    ("Back", "Torso", "Torso2", "Torso3"),
    ("Neck1", "Neck2", "Neck3"),
    ("FrontUpperLeg.{}", "FrontLowerLeg.{}", "IKFrontLeg.{}", "FF.{}"),
    ("BackLeg.{}", "BackUpperLeg.{}", "BackLowerLeg.{}", "IKBackLeg.{}", "FFB.{}"),
)
_HUMANS = _Names(
    ("Hips", "Abdomen", "Torso", "Chest"),
    ("Neck",),
    ("UpperArm.{}", "LowerArm.{}", "Hand.{}"),
    ("UpperLeg.{}", "LowerLeg.{}", "Foot.{}"),
    "people",
)
_KNIGHT = replace(
    _HUMANS, trunk=("Body", "Hips", "Abdomen", "Torso"), fore=("UpperArm.{}", "LowerArm.{}", "Palm.{}")
)
_TAIL = tuple(f"Tail{number}" for number in range(1, 10))


def find_skeleton(rig: Rig) -> Skeleton | None:
    """Return the body parts of a rig, found by node names, or None if the skeleton is unknown.

    The quadrupeds and people of Quaternius, https://quaternius.com, are known.

    Raises:
        LooseRigError: see `find_joints`.
    """
    position = {name: index for index, name in enumerate(rig.names)}
    for names in (_QUADRUPEDS, _HUMANS, _KNIGHT):
        sided = [part.format(side) for part in names.fore + names.hind for side in "RL"]
        if all(name in position for name in (*names.trunk, *names.neck, "Head", *sided)):
            return _skeleton(rig, names, position)
    return None


def _skeleton(rig: Rig, names: _Names, position: Mapping[str, int]) -> Skeleton:
    def nodes(parts: Sequence[str], side: str = "") -> tuple[int, ...]:
        return tuple(position[part.format(side)] for part in parts if part.format(side) in position)

    fore, hind = ((nodes(limb, "R"), nodes(limb, "L")) for limb in (names.fore, names.hind))
    trunk = nodes(names.trunk)
    world = world_matrices(rig.nodes)
    places = world[:, :3, 3]
    up = np.array([0.0, 1.0, 0.0])  # glTF 2.0, section 3.4
    left = places[fore[1][0]] - places[fore[0][0]]
    left -= (left @ up) * up
    left /= np.linalg.norm(left)
    axes = np.column_stack([left, up, np.cross(left, up)])
    places = places @ axes
    joints = find_joints(rig)
    parents = rig.nodes.parents.copy()
    parents[joints.nodes] = np.where(joints.parents >= 0, joints.nodes[joints.parents], -1)
    # If both legs are attached to bones that move no surface, one leg would become a child of the other.
    parents[[leg[0] for leg in hind if parents[leg[0]] in (-1, *hind[0], *hind[1])]] = trunk[0]
    points, owners = owned_vertices(rig)
    tips, points = places.copy(), points @ axes
    for node in np.unique(owners):
        tips[node] = points[owners == node].mean(axis=0)
    return Skeleton(
        names.kind or ("paws" if _elbows(places[list(fore[0])]) else "hooves"),
        trunk,
        nodes(names.neck),
        position["Head"],
        nodes(_TAIL),
        fore,
        hind,
        tuple(int(parent) for parent in parents),
        places,
        tips,
        axes,
    )


def _elbows(leg: Doubles) -> bool:
    """Return whether a foreleg (J, 3) has an elbow, a second joint behind the line of its neighbours."""
    above, joint, below = leg[:3]
    fraction = (above[1] - joint[1]) / (above[1] - below[1])
    return bool(joint[2] < above[2] + fraction * (below[2] - above[2]))


def draw_posture(kind: str, rng: np.random.Generator) -> Posture:
    """Return a random posture for a kind of body; angles vary around the table, and half are mirrored."""
    table = POSTURES[kind]
    posture = table[list(table)[rng.integers(len(table))]]
    wide = posture.spread

    def off(*angles: float, by: Sequence[float] | Doubles | float = wide) -> _Bend:
        a, b, c = np.asarray(angles) + rng.uniform(-1.0, 1.0, 3) * by
        return float(a), float(b), float(c)

    def limb(ways: _Limb) -> _Limb:
        moved: list[_Way] = []
        for way in ways:
            forward, outward = rng.uniform(-1.0, 1.0, 2)
            moved.append(None if way is None else (way[0] + wide * forward, way[1] + wide / 2 * outward))
        return tuple(moved)

    fore, hind = posture.fore, posture.hind
    spine, neck, head, tail, mirror = posture.spine, posture.neck, posture.head, posture.tail, 1
    if rng.random() < 0.5:
        fore, hind, mirror = fore[::-1], hind[::-1], -1
    turned = np.array([1, mirror, mirror])
    return replace(
        posture,
        fore=(limb(fore[0]), limb(fore[1])),
        hind=(limb(hind[0]), limb(hind[1])),
        pitch=posture.pitch + wide * rng.uniform(-1.0, 1.0),
        spine=off(*turned * spine, by=wide),
        neck=off(*turned * neck, by=posture.free),
        head=off(*turned * head, by=posture.free),
        tail=off(*turned * tail, by=2 * np.array(posture.free)),
        whole=off(*turned * posture.whole, by=0.15 * np.abs(posture.whole)),
    )


def in_posture(rig: Rig, skeleton: Skeleton, posture: Posture) -> Doubles:
    """Return the matrices (N, 4, 4) of the nodes in a posture.

    Args:
        rig: rig with its nodes in the rest pose.
        skeleton: body parts of the rig.
        posture: posture for the skeleton's kind, from `draw_posture`.
    """
    if posture.level:
        posture = replace(posture, pitch=_level(skeleton, posture))
    turns, places = _placed(skeleton, posture)
    world = world_matrices(rig.nodes)
    whole = skeleton.axes @ _turn(posture.whole)
    moved = world.copy()
    moved[:, :3, :3] = whole @ turns @ skeleton.axes.T @ world[:, :3, :3]
    moved[:, :3, 3] = places @ whole.T
    return moved


def _placed(skeleton: Skeleton, posture: Posture) -> tuple[Doubles, Doubles]:
    """Return the rotations (N, 3, 3) of the nodes from the rest pose, and positions (N, 3), in body axes."""
    bends, targets = _bends(skeleton, posture), _targets(skeleton, posture)
    turns = np.tile(np.eye(3), (len(skeleton.parents), 1, 1))
    places = skeleton.places.copy()
    for node in _parents_first(skeleton.parents):
        above = skeleton.parents[node]
        if above >= 0:
            turns[node] = turns[above]
            places[node] = places[above] + turns[above] @ (skeleton.places[node] - skeleton.places[above])
        if node in bends:
            turns[node] = turns[node] @ bends[node]
        elif node in targets:
            rest, target = targets[node]
            turns[node] = _swing(turns[node] @ rest, target) @ turns[node]
    return turns, places


def _bends(skeleton: Skeleton, posture: Posture) -> dict[int, Doubles]:
    """Return the rotation (3, 3) of each bent node; the nodes of spine, neck and tail share their bend."""
    bends = {skeleton.trunk[0]: _turn((posture.pitch, 0.0, 0.0)), skeleton.head: _turn(posture.head)}
    pitch, yaw, roll = posture.tail
    for nodes, bend in (
        (skeleton.trunk[1:], posture.spine),
        (skeleton.neck, posture.neck),
        (skeleton.tail, (-pitch, -yaw, roll)),
    ):
        bends |= {node: _turn(tuple(angle / len(nodes) for angle in bend)) for node in nodes}
    return bends


def _targets(skeleton: Skeleton, posture: Posture) -> dict[int, tuple[Doubles, Doubles]]:
    """Return the vector (3,) of each limb segment at rest, and the unit vector (3,) that it should have."""
    targets = {}
    limbs = (*skeleton.fore, *skeleton.hind)
    for nodes, limb, side in zip(limbs, (*posture.fore, *posture.hind), (-1.0, 1.0) * 2, strict=True):
        ends = [*(skeleton.places[node] for node in nodes[1:]), skeleton.tips[nodes[-1]]]
        for node, end, way in zip(nodes, ends, limb, strict=False):  # a limb may leave out its last segments
            if way is not None:
                targets[node] = (end - skeleton.places[node], _direction(way, side))
    return targets


def _parents_first(parents: Sequence[int]) -> list[int]:
    """Return the nodes, each after its parent.

    >>> _parents_first([2, 0, -1])
    [2, 0, 1]
    """
    ordered: dict[int, None] = {}
    for start in range(len(parents)):
        line, node = [], start
        while node >= 0 and node not in ordered and node not in line:  # `line` stops a cycle
            line.append(node)
            node = parents[node]
        ordered |= dict.fromkeys(reversed(line))
    return list(ordered)


def _level(skeleton: Skeleton, posture: Posture) -> float:
    """Return the pitch of the trunk in degrees that puts all feet on the same level."""

    def difference(pitch: float) -> float:
        places = _placed(skeleton, replace(posture, pitch=pitch))[1]
        fore, hind = (min(places[leg[-1], 1] for leg in legs) for legs in (skeleton.fore, skeleton.hind))
        return float(fore - hind)

    low, high = -50.0, 75.0
    for _ in range(8):
        middle = (low + high) / 2
        low, high = (low, middle) if difference(middle) > 0 else (middle, high)
    return (low + high) / 2


def _turn(bend: Sequence[float]) -> Doubles:
    """Return the (3, 3) rotation of a bend in the body's axes."""
    pitch, yaw, roll = bend
    return np.asarray(Rotation.from_euler("YXZ", [yaw, -pitch, roll], degrees=True).as_matrix())


def _direction(way: tuple[float, float], side: float) -> Doubles:
    """Return the unit vector (3,) of a limb segment; ``side`` is 1 on the left, -1 on the right."""
    forward, outward = np.deg2rad(way)
    return np.array(
        [side * np.sin(outward), -np.cos(forward) * np.cos(outward), np.sin(forward) * np.cos(outward)]
    )


def _swing(start: Doubles, end: Doubles) -> Doubles:
    """Return the smallest rotation (3, 3) that maps one direction (3,) to another."""
    start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine < 1e-9:
        axis, sine = np.array([1.0, 0.0, 0.0]), 1.0  # parallel or opposite: rotate about the left axis
    return np.asarray(Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix())
