"""The bones of bipeds: measures of a body, poses drawn as joint angles, and the skeleton that follows."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from normalgan.animals.frames import Floats, Frame, bend, pitch, roll, yaw
from normalgan.animals.plan import BONE, Rng, around

__all__ = ["STANCES", "Arm", "Girth", "Leg", "Limb", "Measures", "Skeleton", "Stance", "skeleton", "vary"]


@dataclass(frozen=True)
class Girth:
    """A section of the trunk.

    Args:
        half_depth: from front to back.
        half_width: from side to side.
    """

    half_depth: float
    half_width: float


@dataclass(frozen=True)
class Measures:
    """Sizes of a body, in units of an adult's height.

    Args:
        leg: from hip to ankle.
        torso: from the hips to the line of the shoulders.
        neck: from there to the base of the skull.
        head: height of the head.
        arm: from shoulder to wrist.
        hand: length.
        foot: length.
        hips: half the distance of the hip joints.
        shoulders: half the distance of the shoulder joints.
        chest: its girth.
        waist: its girth.
        pelvis: its girth.
        belly: how far it bulges ahead of the waist; 0 for none.
        thigh: radius.
        calf: radius.
        upper_arm: radius.
        forearm: radius.
        stoop: degrees by which it leans forward at rest.
        crouch: degrees by which its knees are bent at rest.
    """

    leg: Annotated[float, BONE] = 0.47
    torso: float = 0.30
    neck: float = 0.055
    head: float = 0.140
    arm: Annotated[float, BONE] = 0.33
    hand: float = 0.095
    foot: float = 0.15
    hips: float = 0.055
    shoulders: float = 0.118
    chest: Girth = Girth(0.068, 0.108)
    waist: Girth = Girth(0.056, 0.082)
    pelvis: Girth = Girth(0.066, 0.094)
    belly: float = 0.0
    thigh: float = 0.054
    calf: float = 0.037
    upper_arm: float = 0.032
    forearm: float = 0.026
    stoop: float = 0.0
    crouch: float = 0.0


@dataclass(frozen=True, eq=False)
class Limb:
    """Where a limb is, right-handed, in the frame of the trunk's end that it grows from.

    Args:
        points: (3, 3) shoulder, elbow, wrist; or hip, knee, ankle.
        end: frame of the hand or foot: its -y runs on along the forearm; a foot's x to the toes.
    """

    points: Floats
    end: Frame


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Where everything is.

    Args:
        spine: (6, 3) crotch, hips, waist, chest, shoulders, base of the neck.
        turns: (6, 3, 3) rotation from rest at each.
        chest: frame at the line of the shoulders.
        skull: base of the skull, upright whatever the trunk does.
        legs: right and left, the left one as if it were right, in the frame of the world.
        arms: right and left, the left one as if it were right, in the frame of the chest.
    """

    spine: Floats
    turns: Floats
    chest: Frame
    skull: Frame
    legs: tuple[Limb, Limb]
    arms: tuple[Limb, Limb]


@dataclass(frozen=True)
class Leg:
    """Angles in degrees: of the thigh forward and outward, of the knee's fold, of the toes upward."""

    swing: float = 0.0
    out: float = 4.0
    knee: float = 3.0
    toes: float = 0.0


@dataclass(frozen=True)
class Arm:
    """Angles in degrees: of the upper arm forward and outward, about its length, of the elbow's fold."""

    swing: float = 0.0
    out: float = 12.0
    twist: float = 0.0
    elbow: float = 12.0


@dataclass(frozen=True)
class Stance:
    """A pose.

    Args:
        legs: right and left.
        arms: right and left.
        lean: degrees the trunk leans forward.
        twist: degrees the chest is turned to the left against the hips.
        nod: degrees the face is raised.
        turn: degrees the head is turned to the left.
    """

    legs: tuple[Leg, Leg]
    arms: tuple[Arm, Arm]
    lean: float = 0.0
    twist: float = 0.0
    nod: float = 0.0
    turn: float = 0.0


def _head(stance: Stance, rng: Rng) -> Stance:
    return replace(stance, nod=rng.uniform(-8, 8), turn=rng.normal(0, 14))


def _hanging(rng: Rng) -> Arm:
    return Arm(rng.uniform(-12, 14), rng.uniform(12, 28), rng.uniform(0, 30), rng.uniform(8, 35))


def _stand(rng: Rng) -> Stance:
    out = rng.uniform(4, 11)
    legs = (Leg(rng.uniform(-2, 6), out), Leg(rng.uniform(-6, 3), out))
    return _head(Stance(legs, (_hanging(rng), _hanging(rng)), lean=rng.uniform(-2, 5)), rng)


def _stride(rng: Rng, swing: float, knee: float, elbow: float, lean: float) -> Stance:
    wide = swing * rng.uniform(0.75, 1.1)
    ahead = Leg(wide, 2.0, 0.25 * knee, 10.0)
    behind = Leg(-0.7 * wide, 2.0, knee, -25.0)
    with_leg, against = Arm(-wide, 12.0, 10.0, elbow * 0.7), Arm(wide, 12.0, 10.0, elbow)
    stance = Stance((ahead, behind), (with_leg, against), lean, rng.uniform(4, 14))
    if rng.uniform() < 0.5:
        stance = replace(stance, legs=(behind, ahead), arms=(against, with_leg), twist=-stance.twist)
    return _head(stance, rng)


def _sit(rng: Rng) -> Stance:
    """On a bench nobody sees, or on the ground with the legs ahead."""
    ground = rng.uniform() < 0.5
    knee, out = (rng.uniform(5, 30), 16.0) if ground else (rng.uniform(75, 95), 9.0)
    legs = tuple(Leg(88.0, out + rng.uniform(-3, 6), knee, 0.0) for _ in range(2))
    arms = tuple(Arm(rng.uniform(20, 38), 14.0, 15.0, rng.uniform(25, 60)) for _ in range(2))
    return _head(Stance((legs[0], legs[1]), (arms[0], arms[1]), lean=rng.uniform(-8, 6)), rng)


def _wave(rng: Rng) -> Stance:
    stance = _stand(rng)
    up = Arm(0.0, rng.uniform(80, 115), -90.0, rng.uniform(30, 85))
    hand = int(rng.integers(2))
    return replace(stance, arms=(up, stance.arms[1]) if hand else (stance.arms[0], up))


def _arms_out(rng: Rng) -> Stance:
    """Both arms stretched sideways, or raised."""
    stance = _stand(rng)
    out, elbow = rng.uniform(62, 140), rng.uniform(0, 20)
    twist = -90.0 if out > 100 else 0.0
    return replace(stance, arms=(Arm(0.0, out, twist, elbow), Arm(0.0, out, twist, elbow)))


STANCES: Mapping[str, Callable[[Rng], Stance]] = {
    "stand": _stand,
    "walk": partial(_stride, swing=28.0, knee=26.0, elbow=25.0, lean=4.0),
    "run": partial(_stride, swing=52.0, knee=85.0, elbow=90.0, lean=14.0),
    "sit": _sit,
    "wave": _wave,
    "arms_out": _arms_out,
}


def vary(measures: Measures, spread: float, rng: Rng) -> Measures:
    """Return an individual's measures: lengths each on their own, all girths by one factor."""
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


def skeleton(measures: Measures, stance: Stance) -> Skeleton:
    """Return the bones of a body in a pose, the hips at the origin."""
    heights = np.array([-0.16, 0.0, 0.36, 0.70, 0.93, 1.06]) * measures.torso
    rest = np.column_stack([np.zeros(6), heights, np.zeros(6)])
    spine, turns = bend(rest, -(stance.lean + measures.stoop) * 1.2, 0.0)
    spine = spine - spine[1]
    turns = np.array([turn @ yaw(stance.twist * i / 5) for i, turn in enumerate(turns)])
    chest = Frame(spine[4], turns[4])
    up = turns[5] @ np.array([0.25, 1.0, 0.0])
    skull = Frame(spine[5] + measures.neck * up, yaw(stance.turn + 0.5 * stance.twist) @ pitch(stance.nod))
    legs = tuple(_leg(measures, leg) for leg in stance.legs)
    arms = tuple(_arm(measures, arm) for arm in stance.arms)
    return Skeleton(spine, turns, chest, skull, (legs[0], legs[1]), (arms[0], arms[1]))


def _leg(measures: Measures, leg: Leg) -> Limb:
    hip = np.array([0.0, 0.0, measures.hips])
    upper = roll(leg.out) @ pitch(leg.swing + measures.crouch)
    lower = roll(leg.out * 0.6) @ pitch(leg.swing - leg.knee - measures.crouch)
    knee = hip + upper @ np.array([0.0, -0.5 * measures.leg, 0.0])
    ankle = knee + lower @ np.array([0.0, -0.5 * measures.leg, 0.0])
    # A standing foot lies flat; one whose shin is level points its toes up.
    tilt = 90.0 if leg.swing > 60 and leg.knee < 45 else leg.toes
    return Limb(np.array([hip, knee, ankle]), Frame(ankle, yaw(-8.0) @ pitch(tilt)))


def _arm(measures: Measures, arm: Arm) -> Limb:
    shoulder = np.array([0.0, 0.0, measures.shoulders])
    upper = roll(arm.out) @ pitch(arm.swing) @ yaw(arm.twist)
    lower = upper @ pitch(arm.elbow)
    elbow = shoulder + upper @ np.array([0.0, -0.53 * measures.arm, 0.0])
    wrist = elbow + lower @ np.array([0.0, -0.47 * measures.arm, 0.0])
    return Limb(np.array([shoulder, elbow, wrist]), Frame(wrist, lower))
