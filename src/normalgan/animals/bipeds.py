"""The body plan of bipeds: proportions, poses as joint angles, bones, and flesh or metal around them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Annotated, Literal

import numpy as np

from normalgan.animals.bipeds_heads import HEADS
from normalgan.animals.bipeds_heads import robot as robot_head
from normalgan.animals.frames import Frame, bend, pitch, roll, spanned, unit, yaw
from normalgan.animals.parts import Part, Ripple, ball, block, both, carried, fuse, on_side, tube
from normalgan.animals.plan import PosedPlan, Rng, around
from normalgan.animals.shapes import Shape, Sweep
from normalgan.animals.tables import Bone, Kinds, Number, Table
from normalgan.arrays import Doubles
from normalgan.ranges import OneOf, Range

_FLAT_HAND = 0.17  # half thickness of a palm, in hand lengths


@dataclass(frozen=True)
class Girth(Table):
    """A cross section of the trunk.

    Args:
        half_depth: half of the extent from front to back.
        half_width: half of the extent from side to side.
    """

    half_depth: Number
    half_width: Number


@dataclass(frozen=True)
class Measures(Table):
    """Sizes of a body, in units of an adult's height.

    Args:
        leg: length from hip to ankle.
        torso: length from the hips to the line of the shoulders.
        neck: length from the line of the shoulders to the base of the skull.
        head: height of the head.
        arm: length from shoulder to wrist.
        hand: length of the hand.
        foot: length of the foot.
        hips: half of the distance between the hip joints.
        shoulders: half of the distance between the shoulder joints.
        chest: cross section of the chest.
        waist: cross section of the waist.
        pelvis: cross section of the pelvis.
        belly: distance by which the belly bulges beyond the waist; 0 for no belly.
        thigh: radius of the thigh.
        calf: radius of the calf.
        upper_arm: radius of the upper arm.
        forearm: radius of the forearm.
        stoop: forward lean of the trunk at rest, in degrees.
        crouch: bend of the knees at rest, in degrees.
    """

    leg: Bone = 0.47
    torso: Number = 0.30
    neck: Number = 0.055
    head: Number = 0.140
    arm: Bone = 0.33
    hand: Number = 0.095
    foot: Number = 0.15
    hips: Number = 0.055
    shoulders: Number = 0.118
    chest: Girth = Girth(0.068, 0.108)
    waist: Girth = Girth(0.056, 0.082)
    pelvis: Girth = Girth(0.066, 0.094)
    belly: Number = 0.0
    thigh: Number = 0.054
    calf: Number = 0.037
    upper_arm: Number = 0.032
    forearm: Number = 0.026
    stoop: Number = 0.0
    crouch: Number = 0.0


@dataclass(frozen=True, eq=False)
class _Limb:
    """A right limb, in the frame of the end of the trunk that it is attached to.

    Args:
        points: (3, 3) positions of shoulder, elbow and wrist, or of hip, knee and ankle.
        end: frame of the hand or foot. Its -y axis continues the forearm, and the x axis of a foot points
            to the toes.
    """

    points: Doubles
    end: Frame


@dataclass(frozen=True, eq=False)
class Bones:
    """Positions of all bones.

    Args:
        spine: (6, 3) positions of crotch, hips, waist, chest, shoulders and base of the neck.
        turns: (6, 3, 3) rotations from rest at these positions.
        chest: frame at the line of the shoulders.
        skull: frame at the base of the skull, always upright.
        legs: right and left leg in the frame of the world, the left leg mirrored to the right.
        arms: right and left arm in the frame of the chest, the left arm mirrored to the right.
    """

    spine: Doubles
    turns: Doubles
    chest: Frame
    skull: Frame
    legs: tuple[_Limb, ...]
    arms: tuple[_Limb, ...]


@dataclass(frozen=True)
class _Leg:
    """Angles in degrees: thigh forward and outward, flexion of the knee, and toes upwards."""

    swing: float = 0.0
    out: float = 4.0
    knee: float = 3.0
    toes: float = 0.0


@dataclass(frozen=True)
class _Arm:
    """Angles in degrees: upper arm forward and outward, rotation about its axis, and flexion of the elbow."""

    swing: float = 0.0
    out: float = 12.0
    twist: float = 0.0
    elbow: float = 12.0


@dataclass(frozen=True)
class Stance:
    """A pose.

    Args:
        legs: angles of right and left leg.
        arms: angles of right and left arm.
        lean: forward lean of the trunk in degrees.
        twist: rotation of the chest relative to the hips, to the left, in degrees.
        nod: upward pitch of the face in degrees.
        turn: rotation of the head to the left in degrees.
    """

    legs: tuple[_Leg, ...]
    arms: tuple[_Arm, ...]
    lean: float = 0.0
    twist: float = 0.0
    nod: float = 0.0
    turn: float = 0.0


def _looking(stance: Stance, rng: Rng) -> Stance:
    return replace(stance, nod=rng.uniform(-8, 8), turn=rng.normal(0, 14))


def _hanging(rng: Rng) -> _Arm:
    return _Arm(rng.uniform(-12, 14), rng.uniform(12, 28), rng.uniform(0, 30), rng.uniform(8, 35))


def _stand(rng: Rng) -> Stance:
    out = rng.uniform(4, 11)
    legs = (_Leg(rng.uniform(-2, 6), out), _Leg(rng.uniform(-6, 3), out))
    return _looking(Stance(legs, (_hanging(rng), _hanging(rng)), lean=rng.uniform(-2, 5)), rng)


def _stride(rng: Rng, swing: float, knee: float, elbow: float, lean: float) -> Stance:
    wide = swing * rng.uniform(0.75, 1.1)
    ahead = _Leg(wide, 2.0, 0.25 * knee, 10.0)
    behind = _Leg(-0.7 * wide, 2.0, knee, -25.0)
    with_leg, against = _Arm(-wide, 12.0, 10.0, elbow * 0.7), _Arm(wide, 12.0, 10.0, elbow)
    stance = Stance((ahead, behind), (with_leg, against), lean, rng.uniform(4, 14))
    if rng.uniform() < 0.5:
        stance = replace(stance, legs=(behind, ahead), arms=(against, with_leg), twist=-stance.twist)
    return _looking(stance, rng)


def _sit(rng: Rng) -> Stance:
    """Return a stance that sits on an invisible bench, or on the ground with stretched legs."""
    ground = rng.uniform() < 0.5
    knee, out = (rng.uniform(5, 30), 16.0) if ground else (rng.uniform(75, 95), 9.0)
    legs = tuple(_Leg(88.0, out + rng.uniform(-3, 6), knee, 0.0) for _ in range(2))
    arms = tuple(_Arm(rng.uniform(20, 38), 14.0, 15.0, rng.uniform(25, 60)) for _ in range(2))
    return _looking(Stance(legs, arms, lean=rng.uniform(-8, 6)), rng)


def _wave(rng: Rng) -> Stance:
    stance = _stand(rng)
    up = _Arm(0.0, rng.uniform(80, 115), -90.0, rng.uniform(30, 85))
    hand = int(rng.integers(2))
    return replace(stance, arms=(up, stance.arms[1]) if hand else (stance.arms[0], up))


def _arms_out(rng: Rng) -> Stance:
    """Return a stance with both arms stretched sideways or raised."""
    stance = _stand(rng)
    out, elbow = rng.uniform(62, 140), rng.uniform(0, 20)
    twist = -90.0 if out > 100 else 0.0
    return replace(stance, arms=(_Arm(0.0, out, twist, elbow), _Arm(0.0, out, twist, elbow)))


STANCES: Mapping[str, Callable[[Rng], Stance]] = {
    "stand": _stand,
    "walk": partial(_stride, swing=28.0, knee=26.0, elbow=25.0, lean=4.0),
    "run": partial(_stride, swing=52.0, knee=85.0, elbow=90.0, lean=14.0),
    "sit": _sit,
    "wave": _wave,
    "arms_out": _arms_out,
}


def _vary(measures: Measures, spread: float, rng: Rng) -> Measures:
    """Return randomly varied proportions, with one factor per length and a common factor for all radii."""
    lengths = ("leg", "torso", "neck", "head", "arm", "hand", "foot", "shoulders", "stoop")
    usual = (getattr(measures, name) for name in lengths)
    long = dict(zip(lengths, around(rng, spread, *usual), strict=True))
    fat = rng.uniform(1 - 1.3 * spread, 1 + 1.8 * spread)
    thick = {n: getattr(measures, n) * fat for n in ("thigh", "calf", "upper_arm", "forearm", "belly")}
    chest, waist, pelvis = (
        Girth(girth.half_depth * fat, girth.half_width * (1 + 0.6 * (fat - 1)))
        for girth in (measures.chest, measures.waist, measures.pelvis)
    )
    return replace(measures, chest=chest, waist=waist, pelvis=pelvis, **long, **thick)


def skeleton(measures: Measures, stance: Stance) -> Bones:
    """Return the bones of a body in a pose, with the hips at the origin."""
    heights = np.array([-0.16, 0.0, 0.36, 0.70, 0.93, 1.06]) * measures.torso
    rest = np.column_stack([np.zeros(6), heights, np.zeros(6)])
    spine, turns = bend(rest, -(stance.lean + measures.stoop) * 1.2, 0.0)
    spine = spine - spine[1]
    turns = np.array([turn @ yaw(stance.twist * i / 5) for i, turn in enumerate(turns)])
    chest = Frame(spine[4], turns[4])
    up = turns[5] @ np.array([0.25, 1.0, 0.0])
    skull = Frame(spine[5] + measures.neck * up, yaw(stance.turn + 0.5 * stance.twist) @ pitch(stance.nod))
    legs = tuple(_leg_bones(measures, leg) for leg in stance.legs)
    arms = tuple(_arm_bones(measures, arm) for arm in stance.arms)
    return Bones(spine, turns, chest, skull, legs, arms)


def _leg_bones(measures: Measures, leg: _Leg) -> _Limb:
    hip = np.array([0.0, 0.0, measures.hips])
    upper = roll(leg.out) @ pitch(leg.swing + measures.crouch)
    lower = roll(leg.out * 0.6) @ pitch(leg.swing - leg.knee - measures.crouch)
    knee = hip + upper @ np.array([0.0, -0.5 * measures.leg, 0.0])
    ankle = knee + lower @ np.array([0.0, -0.5 * measures.leg, 0.0])
    # A standing foot is flat, but if the shin is horizontal, the toes point up.
    tilt = 90.0 if leg.swing > 60 and leg.knee < 45 else leg.toes
    return _Limb(np.array([hip, knee, ankle]), Frame(ankle, yaw(-8.0) @ pitch(tilt)))


def _arm_bones(measures: Measures, arm: _Arm) -> _Limb:
    shoulder = np.array([0.0, 0.0, measures.shoulders])
    upper = roll(arm.out) @ pitch(arm.swing) @ yaw(arm.twist)
    lower = upper @ pitch(arm.elbow)
    elbow = shoulder + upper @ np.array([0.0, -0.53 * measures.arm, 0.0])
    wrist = elbow + lower @ np.array([0.0, -0.47 * measures.arm, 0.0])
    return _Limb(np.array([shoulder, elbow, wrist]), Frame(wrist, lower))


@dataclass(frozen=True)
class Flesh(Table):
    """Adds flesh to a skeleton.

    Args:
        head: kind of head: human, toon, monkey, gorilla or bear.
        hand: kind of hand: mitt, fingers or paw.
        foot: kind of foot: shoe or paw.
        neck: radius of the neck.
        skirt: probability of a skirt.
        tail: length of the tail; 0 for no tail.
        coat: ripple of the fur; None for smooth skin.
    """

    head: Annotated[str, OneOf(HEADS)]
    hand: Literal["mitt", "fingers", "paw"] = "mitt"
    foot: Literal["shoe", "paw"] = "shoe"
    neck: Number = 0.036
    skirt: Number = 0.0
    tail: Number = 0.0
    coat: Ripple | None = None

    def parts(self, measures: Measures, bones: Bones, rng: Rng) -> list[Part]:
        """Return the parts in blending order."""
        coat = self.coat
        parts = [fuse(_trunk(measures, bones), ripple=coat)]
        if measures.belly:
            parts.append(fuse(_belly(measures, bones), blend=0.05, ripple=coat))
        dressed = bool(rng.uniform() < self.skirt)
        parts.append(fuse(*_each(bones.legs, partial(_leg, measures)), blend=0.03, ripple=coat))
        parts.append(fuse(*_each(bones.legs, partial(_foot, self.foot, measures)), blend=0.012))
        if dressed and bones.legs[0].points[1, 0] - bones.legs[0].points[0, 0] < 0.3 * measures.leg:
            parts.append(fuse(_skirt(measures, bones), blend=0.006))
        arms = fuse(*_each(bones.arms, partial(_arm, measures)), blend=0.022, ripple=coat)
        hands = fuse(*_each(bones.arms, partial(_hand, self.hand, measures)), blend=0.010)
        parts += carried([arms, hands], bones.chest)
        throat = bones.skull.place(np.array([0.08, 0.3, 0.0]) * measures.head)
        neck = tube([bones.chest.origin, bones.skull.origin, throat], self.neck)
        parts.append(fuse(neck, blend=0.045, ripple=coat))
        parts += carried(HEADS[self.head](rng), bones.skull, measures.head)
        if self.tail:
            parts.append(fuse(_tail(self.tail, bones, rng), blend=0.03))
        return parts


@dataclass(frozen=True)
class Robot(Table):
    """Builds a robot of boxes, balls and pipes around a skeleton."""

    def parts(self, measures: Measures, bones: Bones, rng: Rng) -> list[Part]:
        """Return the parts in blending order."""
        edge = rng.uniform(0.012, 0.04)
        boxy = bool(rng.uniform() < 0.5)
        depth, width = measures.chest.half_depth, measures.chest.half_width
        chest = bones.chest
        half = 0.36 * measures.torso
        middle = chest.place(np.array([0.0, -half, 0.0]))
        parts = [
            fuse(block(middle, [depth, 1.25 * half, width], edge, chest.rotation)),
            fuse(block(bones.spine[1], [measures.pelvis.half_depth, 0.04, measures.pelvis.half_width], edge)),
            fuse(tube([bones.spine[1], bones.spine[2], middle], 0.7 * measures.waist.half_depth)),
            fuse(*(one.placed(chest) for one in _panel(depth, half, width, rng))),
            fuse(tube([chest.origin, bones.skull.place(np.array([0.0, 0.1, 0.0]) * measures.head)], 0.035)),
        ]

        def leg(limb: _Limb) -> list[Shape]:
            return [*_pipes(limb, measures.thigh, measures.calf, edge, boxy), *_boot(limb, measures, edge)]

        def arm(limb: _Limb) -> list[Shape]:
            shoulder = tube([[0, 0, 0], limb.points[0]], 0.8 * measures.upper_arm)
            bones = _pipes(limb, measures.upper_arm, measures.forearm, edge, boxy)
            return [*bones, *_claw(limb, measures), shoulder]

        arms = [shape.placed(chest) for shape in _each(bones.arms, arm)]
        parts.append(fuse(*_each(bones.legs, leg), *arms))
        return parts + carried(robot_head(rng), bones.skull, measures.head)


@dataclass(frozen=True)
class Biped(PosedPlan):
    """A species that walks on two legs.

    Args:
        body: flesh around the bones.
        measures: average proportions.
        spread: relative variation of the measures, at most 0.5.
    """

    habits: tuple[Annotated[str, OneOf(STANCES)], ...]
    body: Annotated[Flesh | Robot, Kinds(flesh=Flesh, robot=Robot)]
    measures: Measures = field(default_factory=Measures)
    spread: Annotated[float, Range(0, 0.5)] = 0.09

    @property
    def poses(self) -> tuple[str, ...]:
        """The poses of all bipeds."""
        return tuple(STANCES)

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        measures = _vary(self.measures, self.spread, rng)
        return self.body.parts(measures, skeleton(measures, STANCES[pose](rng)), rng)


def _each(limbs: Sequence[_Limb], shapes: Callable[[_Limb], list[Shape]]) -> list[Shape]:
    """Return the shapes of the right limb, and the mirrored shapes of the left limb."""
    sides = zip((True, False), limbs, strict=True)
    return [on_side(shape, right) for right, limb in sides for shape in shapes(limb)]


def _trunk(measures: Measures, bones: Bones) -> Sweep:
    """Return the trunk, from the crotch to the base of the neck."""
    pelvis, waist, chest = (
        np.array([girth.half_depth, girth.half_width])
        for girth in (measures.pelvis, measures.waist, measures.chest)
    )
    rows = np.array([0.6 * pelvis, pelvis, waist, chest, 0.8 * chest, 0.45 * chest])
    points = bones.spine.copy()
    points[-1] = (points[-1] + points[-2]) / 2
    return tube(points, rows[:, 0], rows[:, 1], side=bones.turns[:, :, 2])


def _belly(measures: Measures, bones: Bones) -> Shape:
    at, turn = (bones.spine[1] + 1.4 * bones.spine[2]) / 2.4, bones.turns[2]
    size = np.array([measures.waist.half_depth, 0.40 * measures.torso, 1.02 * measures.waist.half_width])
    return ball(at + turn @ np.array([measures.belly, 0.0, 0.0]), size, turn)


def _leg(measures: Measures, limb: _Limb) -> list[Shape]:
    hip, knee, ankle = limb.points
    thigh, calf = measures.thigh, measures.calf
    behind = np.cross([0.0, 0.0, 1.0], unit(limb.end.origin - knee)) * -0.3 * calf
    rows = [hip, hip * 0.6 + knee * 0.4, knee, knee * 0.68 + ankle * 0.32 + behind, ankle]
    return [tube(rows, [1.12 * thigh, thigh, 0.5 * (thigh + calf) * 0.9, calf, 0.62 * calf])]


def _foot(kind: str, measures: Measures, limb: _Limb) -> list[Shape]:
    size = measures.foot
    low = 0.20 * size
    if kind == "paw":
        rows = [[-0.18, -0.12, 0], [0.25, -0.12, 0], [0.62, -0.16, 0]]
        thick, wide = [0.26, 0.25, 0.17], [0.24, 0.30, 0.28]
    else:
        rows = [[-0.20, -0.16, 0], [0.10, -0.14, 0], [0.42, -0.20, 0.01], [0.66, -0.23, 0.02]]
        thick, wide = [0.17, 0.19, 0.145, 0.11], [0.17, 0.18, 0.20, 0.16]
    sole = tube(np.array(rows) * size, np.array(thick) * size, np.array(wide) * size)
    shank = tube([(0.0, low), (0.0, -0.3 * low)], 0.62 * measures.calf)
    return [sole.placed(limb.end), shank.placed(limb.end)]


def _arm(measures: Measures, limb: _Limb) -> list[Shape]:
    shoulder, elbow, wrist = limb.points
    upper, fore = measures.upper_arm, measures.forearm
    inner = shoulder + np.array([0.0, -0.1 * upper, -0.6 * upper])
    rows = [inner, shoulder, shoulder * 0.55 + elbow * 0.45, elbow, elbow * 0.7 + wrist * 0.3, wrist]
    radii = [1.15 * upper, 1.2 * upper, upper, 0.55 * (upper + fore) * 0.82, fore, 0.68 * fore]
    return [tube(rows, radii)]


def _hand(kind: str, measures: Measures, limb: _Limb) -> list[Shape]:
    """Return a hand with the palm towards the thigh and the thumb forward when the arm hangs down."""
    size, flat = measures.hand, _FLAT_HAND
    if kind == "paw":
        return [ball((0.05 * size, -0.32 * size), np.array([0.4, 0.5, 0.34]) * size).placed(limb.end)]
    palm = ball((0.02, -0.38), [0.26, 0.44, flat])
    thumb = tube([[0.16, -0.22, 0.0], [0.33, -0.42, -0.05], [0.36, -0.58, -0.08]], [0.1, 0.095, 0.075])
    shapes: list[Shape] = [palm, thumb]
    if kind == "mitt":
        fingers = [[0.02, -0.45, 0], [0.03, -0.78, -0.05]]
        shapes.append(tube(fingers, [flat, 0.8 * flat], [0.24, 0.17], (1, 0, 0)))
    else:
        for at, far in ((-0.2, 0.86), (-0.07, 1.0), (0.06, 1.03), (0.19, 0.95)):
            knuckle, tip = [at * 0.85, -0.6, 0.0], [at * 1.35, -far, -0.12]
            middle = [at * 1.1, -0.5 * (0.6 + far), -0.02]
            shapes.append(tube([knuckle, middle, tip], [0.085, 0.08, 0.065]))
    return [shape.placed(limb.end, size) for shape in shapes]


def _skirt(measures: Measures, bones: Bones) -> Shape:
    """Return a cone around the hips and thighs."""
    waist, hips = bones.spine[2], bones.spine[1]
    hem = hips + np.array([0.0, -0.42 * measures.leg, 0.0])
    hem[0] = np.mean([limb.points[1, 0] for limb in bones.legs])
    depth, width = measures.pelvis.half_depth, measures.pelvis.half_width
    far = max(abs(limb.points[1, 0] - hem[0]) for limb in bones.legs) + measures.thigh
    rows = [waist, hips, hem]
    radii = [measures.waist.half_depth * 1.05, depth * 1.2, max(far, depth) * 1.15]
    return tube(rows, radii, [measures.waist.half_width * 1.05, width * 1.2, width * 1.75], flat=True)


def _tail(length: float, bones: Bones, rng: Rng) -> Shape:
    lift, aside = rng.uniform(0.1, 0.7), rng.normal(0, 0.25)
    rows = np.array([[0, 0, 0], [-0.25, -0.08, 0.1], [-0.55, 0.0, 0.4], [-0.72, 0.5, 0.7], [-0.6, 0.95, 1.0]])
    rows = rows * [1.0, lift, aside] * length
    start = Frame(bones.spine[1] + np.array([-0.04, 0.0, 0.0]), np.eye(3))
    return tube(rows, [0.026, 0.022, 0.019, 0.017, 0.016]).placed(start)


def _panel(depth: float, half: float, width: float, rng: Rng) -> list[Shape]:
    """Return the parts on the chest: a plate, or knobs."""
    if rng.uniform() < 0.5:
        return [block((depth, -half), [0.014, 0.6 * half, 0.6 * width], 0.01)]
    knobs = both(tube([[x, -0.5 * half, 0.4 * width] for x in (depth - 0.01, depth + 0.014)], 0.02))
    return [*knobs, block((depth, -1.2 * half), [0.012, 0.3 * half, 0.6 * width], 0.01)]


def _pipes(limb: _Limb, upper: float, lower: float, edge: float, boxy: bool) -> list[Shape]:
    """Return two boxes or pipes with balls as joints."""
    first, second, third = limb.points
    shapes: list[Shape] = [ball(first, 1.15 * upper), ball(second, 1.12 * lower), ball(third, 0.9 * lower)]
    for start, end, radius in ((first, second, upper), (second, third, lower)):
        if boxy:
            half = [radius, 0.42 * float(np.linalg.norm(end - start)), radius]
            shapes.append(block((start + end) / 2, half, edge, _upright(start - end)))
            shapes.append(tube([start, end], 0.55 * radius))
        else:
            shapes.append(tube([start, end], 0.85 * radius))
    return shapes


def _boot(limb: _Limb, measures: Measures, edge: float) -> list[Shape]:
    size = measures.foot
    boot = block((0.22 * size, -0.12 * size), [0.55 * size, 0.2 * size, 0.28 * size], edge)
    return [boot.placed(limb.end)]


def _claw(limb: _Limb, measures: Measures) -> list[Shape]:
    """Return a gripper: an open ring."""
    size = measures.hand
    jaw = [[0.0, -0.2, 0], [0.38, -0.4, 0], [0.4, -0.75, 0], [0.16, -1.0, 0]]
    cuff = tube([(0, 0.1), (0, -0.25)], 0.26)
    jaws = [tube(jaw, 0.13), tube(np.array(jaw) * [-1, 1, 1], 0.13), cuff]
    return [shape.placed(limb.end, size) for shape in jaws]


def _upright(axis: Doubles) -> Doubles:
    """Return a rotation with its second column along ``axis`` and its first pointing forward."""
    up = unit(axis)
    aside = np.array([0.0, 1.0, 0.0] if 1 - up[2] ** 2 < 0.3**2 else [0.0, 0.0, 1.0])
    return spanned(np.zeros(3), up, aside).rotation[:, [2, 0, 1]]
