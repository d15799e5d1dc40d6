"""Random poses: a posture, a frame of an animation, or joints rotated within their ranges.

Postures are sitting, lying, rearing and other poses of known skeletons that are rare in animations.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

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
    share = rng.beta(2.0, 2.0, joints.low.shape)
    return turned(world_matrices(rig.nodes), joints, joints.low + share * (joints.high - joints.low))


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


def _both(*limb: _Way) -> tuple[_Limb, _Limb]:
    return limb, limb


_REST: tuple[_Limb, _Limb] = ((), ())
_PAW_SIT = _both((72, 12), (-62, 6), (80, 2), (85, 0))
_PAW_LIE = _both((62, 14), (-78, 8), (86, 4), (90, 0))
_PAWS_AHEAD = _both((-45, 4), (84, 0), (88, 0))
_STRAIGHT_PAWS = _both((-18, 0), (4, 2), None)

_PAWS: Mapping[str, Posture] = {
    "sit": Posture(_STRAIGHT_PAWS, _PAW_SIT, 40, neck=(-15, 0, 0), level=True, spread=5),
    "lie": Posture(_PAWS_AHEAD, _PAW_LIE, level=True, spread=6),
    "lie on the side": Posture(
        (((-10, 2), (35, 0)), ((-25, 2), (15, 0))),
        (((35, 2), (-25, 0), (15, 0)), ((15, 2), (-40, 0), (0, 0))),
        whole=(0, 0, 88),
        spread=14,
        free=(12, 15, 8),
    ),
    "on the back": Posture(
        _both((-20, 14), (95, 6), (20, 0)), _both((45, 28), (-45, 10), (35, 0)), whole=(0, 0, 180), spread=12
    ),
    "rear": Posture(_both((5, 4), (75, 2), (20, 0)), _both((35, 6), (-30, 2), (18, 0)), 58, spread=12),
    "leap": Posture(_both((25, 2), (62, 0), (50, 0)), _both((-35, 4), (-62, 2), (-50, 0)), 8, spread=12),
    "gather": Posture(
        _both((-45, 2), (-10, 0), (-50, 0)), _both((60, 4), (-15, 2), (50, 0)), 0, (-20, 0, 0), spread=12
    ),
    "bow": Posture(
        _both((10, 4), (78, 2), (85, 0)), _REST, level=True, spine=(8, 0, 0), neck=(30, 0, 0), tail=(30, 0, 0)
    ),
    "curl": Posture(
        _PAWS_AHEAD,
        _PAW_LIE,
        0,
        (-5, 65, 0),
        (-15, 60, 0),
        (-10, 20, 0),
        (0, 80, 0),
        free=(6, 12, 6),
        spread=4,
    ),
    "look back": Posture(spine=(0, 18, 0), neck=(10, 75, 0), head=(0, 35, 0)),
    "beg": Posture(_both((-5, 4), (75, 2), (10, 0)), _PAW_SIT, 68, neck=(-40, 0, 0)),
    "give a paw": Posture((((25, 4), (75, 0), (60, 0)), ()), _REST, free=(20, 30, 8)),
    "stalk": Posture(
        (((-70, 2), (25, 0), None), ((-40, 2), (-5, 0), None)),
        (((50, 4), (-65, 2), (25, 0), None), ((30, 4), (-70, 2), (10, 0), None)),
        neck=(-20, 0, 0),
        level=True,
    ),
}

_HOOF_LIE = _both((55, 12), (-84, 6), (86, 4), (90, 0))
_KNEES_UNDER = _both((58, 4), (-95, -2), (-95, 0))

_HOOVES: Mapping[str, Posture] = {
    "sit": Posture(
        _both((-6, 0), (-4, 0)),
        _both((66, 14), (-60, 6), (75, 2), (80, 0)),
        35,
        neck=(-15, 0, 0),
        level=True,
        spread=5,
    ),
    "lie": Posture(_KNEES_UNDER, _HOOF_LIE, level=True, spread=6),
    "lie on the side": Posture(
        (((15, 2), (-20, 0)), ((0, 2), (-35, 0))),
        (((20, 2), (-40, 0), (0, 0)), ((5, 2), (-50, 0), (-10, 0))),
        whole=(0, 0, 88),
        spread=14,
        free=(10, 10, 6),
    ),
    "on the back": Posture(
        _both((25, 10), (-70, 4), (-60, 0)),
        _both((40, 20), (-50, 8), (30, 0)),
        neck=(-45, 0, 0),
        whole=(0, 0, 180),
        spread=12,
    ),
    "rear": Posture(
        (((65, 4), (-25, 0), (-30, 0)), ((45, 4), (-45, 0), (-50, 0))),
        _both((30, 6), (-35, 2), (15, 0)),
        52,
        neck=(-15, 0, 0),
        spread=12,
    ),
    "leap": Posture(_both((55, 2), (35, 0), (20, 0)), _both((-20, 4), (-62, 2), (-55, 0)), 10, spread=12),
    "gather": Posture(_both((30, 2), (-80, 0), (-90, 0)), _both((55, 4), (-25, 2), (45, 0)), 12, spread=12),
    "bow": Posture(_both((45, 4), (70, 2), (80, 0)), _REST, level=True, neck=(20, 0, 0)),
    "kneel": Posture(
        (((15, 2), (-85, 0), (-90, 0)), ((60, 2), (5, 0), None)), _REST, level=True, neck=(-20, 0, 0)
    ),
    "curl": Posture(
        _KNEES_UNDER,
        _HOOF_LIE,
        0,
        (-5, 40, 0),
        (-30, 75, 0),
        (-20, 25, 0),
        (0, 60, 0),
        free=(6, 12, 6),
        spread=4,
    ),
    "look back": Posture(spine=(0, 15, 0), neck=(0, 80, 0), head=(-10, 30, 0)),
    "kick": Posture(_REST, _both((10, 4), (-75, 0), (-60, 0)), -18, neck=(-10, 0, 0), spread=12),
    "lift a foot": Posture((((40, 2), (-45, 0), (-60, 0)), ()), _REST),
}

_DOWN = _both((0, 12), (15, 6), None)
_GUARD = _both((25, 10), (150, -25), (150, -20))
_CHAIR = _both((84, 9), (2, 4))

_PEOPLE: Mapping[str, Posture] = {
    "arms down": Posture(_DOWN, _both((2, 5), (-4, 3)), spread=10),
    "arms up": Posture(_both((165, 22), (172, 8)), _both((0, 8), (-5, 5)), spread=18),
    "cheer": Posture(
        _both((130, 55), (172, 15)), _both((0, 10), (-8, 5)), 5, (8, 0, 0), head=(15, 0, 0), spread=16
    ),
    "wave": Posture((((60, 60), (165, 25)), ((0, 12), (12, 5))), _both((0, 6), (-4, 3)), spread=12),
    "point": Posture((((85, 5), (88, 0)), ((0, 15), (20, 0))), _both((0, 7), (-4, 4)), spread=14),
    "hands on hips": Posture(_both((-15, 48), (20, -35)), _both((0, 9), (-3, 6)), spread=5),
    "arms crossed": Posture((((22, 10), (80, -62)), ((15, 10), (75, -62))), _both((0, 6), (-3, 4)), spread=4),
    "sit on a chair": Posture(_both((20, 10), (70, -8)), _CHAIR, 0, (-8, 0, 0), spread=8),
    "lean back": Posture(_both((-30, 14), (-15, 8)), _both((92, 10), (25, 5)), 22, (-5, 0, 0), spread=8),
    "sit on the ground": Posture(
        _both((45, 10), (60, -6)), _both((115, 9), (-35, 3)), -4, (-28, 0, 0), spread=7
    ),
    "legs out": Posture(_both((-28, 14), (-12, 8)), _both((84, 10), (82, 4)), 12, (-8, 0, 0), spread=7),
    "cross-legged": Posture(_both((25, 14), (55, -12)), _both((72, 52), (42, -70)), 0, (-14, 0, 0), spread=4),
    "kneel": Posture(_both((15, 12), (45, -5)), _both((10, 7), (-86, 2)), 0, (-5, 0, 0), spread=7),
    "sit on the heels": Posture(
        _both((22, 8), (60, -14)), _both((76, 11), (-84, 3)), -2, (-8, 0, 0), spread=5
    ),
    "on one knee": Posture(
        _both((25, 10), (65, -10)), (((88, 6), (4, 2)), ((0, 6), (-84, 2))), -3, (-10, 0, 0), spread=7
    ),
    "crouch": Posture(
        _both((50, 10), (60, -8)), _both((95, 14), (-42, 6)), -22, (-30, 0, 0), head=(25, 0, 0), spread=8
    ),
    "guard": Posture(_GUARD, (((28, 10), (-12, 5)), ((-12, 10), (-28, 5))), -6, (-8, 15, 0), spread=10),
    "punch": Posture(
        (((88, 4), (90, -4)), _GUARD[1]),
        (((40, 8), (-5, 4)), ((-25, 10), (-32, 5))),
        -12,
        (-6, 25, 0),
        spread=9,
    ),
    "kick": Posture(
        _both((35, 25), (110, -15)), (((88, 8), (75, 4)), ((-4, 5), (-10, 3))), 16, (-16, 0, 0), spread=10
    ),
    "lunge": Posture(
        (((70, 10), (85, 0)), ((-30, 25), (0, 10))),
        (((70, 6), (-8, 3)), ((-38, 8), (-45, 5))),
        -10,
        (-8, 0, 0),
        spread=10,
    ),
    "run": Posture(
        (((50, 8), (130, -10)), ((-50, 10), (40, 0))),
        (((-30, 4), (-95, 2)), ((60, 4), (-35, 2))),
        -14,
        spread=10,
    ),
    "leap": Posture(_both((110, 40), (140, 20)), (((65, 8), (20, 3)), ((-40, 8), (-80, 3))), -4, spread=16),
    "star": Posture(_both((95, 62), (100, 55)), _both((0, 34), (-5, 30)), spread=14),
    "bow": Posture(_both((45, 10), (50, 0)), _both((4, 5), (-2, 3)), -35, (-35, 0, 0), spread=10),
    "look behind": Posture(
        _DOWN, (((12, 6), (0, 3)), ((-12, 6), (-18, 3))), 0, (0, 45, 0), (0, 30, 0), (0, 30, 0), spread=10
    ),
    "on all fours": Posture(
        _both((5, 4), (8, 2)), _both((12, 4), (-82, 2)), -78, (-8, 0, 0), (35, 0, 0), (30, 0, 0), spread=6
    ),
    "lie on the back": Posture(
        _both((10, 35), (20, 25)), _both((8, 8), (-4, 5)), whole=(90, 0, 0), spread=14
    ),
    "lie on the side": Posture(
        (((45, 5), (80, 0)), ((60, 10), (100, 0))),
        (((40, 4), (-30, 2)), ((60, 4), (-35, 2))),
        0,
        (-15, 0, 0),
        whole=(0, 0, 88),
        spread=14,
    ),
    "lie on the belly": Posture(
        _both((140, 40), (150, -20)), _both((0, 8), (-6, 5)), whole=(-90, 0, 0), spread=12
    ),
}

POSTURES: Mapping[str, Mapping[str, Posture]] = {"paws": _PAWS, "hooves": _HOOVES, "people": _PEOPLE}
"""The postures of each kind of body, by name."""


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
    share = (above[1] - joint[1]) / (above[1] - below[1])
    return bool(joint[2] < above[2] + share * (below[2] - above[2]))


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
    bends = {skeleton.trunk[0]: _turn((posture.pitch, 0.0, 0.0)), skeleton.head: _turn(posture.head)}
    pitch, yaw, roll = posture.tail
    for nodes, bend in (
        (skeleton.trunk[1:], posture.spine),
        (skeleton.neck, posture.neck),
        (skeleton.tail, (-pitch, -yaw, roll)),
    ):
        bends |= {node: _turn(tuple(angle / len(nodes) for angle in bend)) for node in nodes}
    ways: dict[int, tuple[Doubles, Doubles]] = {}
    for limbs, held in ((skeleton.fore, posture.fore), (skeleton.hind, posture.hind)):
        for nodes, limb, side in zip(limbs, held, (-1.0, 1.0), strict=True):
            for number, (node, way) in enumerate(zip(nodes, limb, strict=False)):
                if way is not None:
                    end = (
                        skeleton.places[nodes[number + 1]] if number + 1 < len(nodes) else skeleton.tips[node]
                    )
                    ways[node] = (end - skeleton.places[node], _direction(way, side))
    turns = np.tile(np.eye(3), (len(skeleton.parents), 1, 1))
    places = skeleton.places.copy()
    done = set()

    def place(node: int) -> None:
        if node in done:
            return
        done.add(node)
        above = skeleton.parents[node]
        if above >= 0:
            place(above)
            turns[node] = turns[above]
            places[node] = places[above] + turns[above] @ (skeleton.places[node] - skeleton.places[above])
        if node in bends:
            turns[node] = turns[node] @ bends[node]
        elif node in ways:
            rest, target = ways[node]
            turns[node] = _swing(turns[node] @ rest, target) @ turns[node]

    for node in range(len(skeleton.parents)):
        place(node)
    return turns, places


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
