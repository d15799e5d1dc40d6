"""Bipeds: a skeleton that a pose bends, and the flesh, or the metal, that goes round it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from normalgan.animals.bipeds_pose import STANCES, Arm, Leg, Stance
from normalgan.animals.chain import Frame, bend, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import roll
from normalgan.animals.plan import Rng
from normalgan.animals.sweep import Floats


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
        chest: half depth and half width.
        waist: half depth and half width.
        pelvis: half depth and half width.
        belly: how far it bulges ahead of the waist; 0 for none.
        thigh: radius.
        calf: radius.
        upper_arm: radius.
        forearm: radius.
        stoop: degrees by which it leans forward at rest.
        crouch: degrees by which its knees are bent at rest.
    """

    leg: float = 0.47
    torso: float = 0.30
    neck: float = 0.055
    head: float = 0.140
    arm: float = 0.33
    hand: float = 0.095
    foot: float = 0.15
    hips: float = 0.055
    shoulders: float = 0.118
    chest: tuple[float, float] = (0.068, 0.108)
    waist: tuple[float, float] = (0.056, 0.082)
    pelvis: tuple[float, float] = (0.066, 0.094)
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


Dress = Callable[[Measures, Skeleton, Rng], list[Part]]


@dataclass(frozen=True)
class Biped:
    """The body plan of those that go on two legs.

    Args:
        measures: of the average individual.
        dress: makes the parts of measures and skeleton.
        habits: the poses drawn from.
        spread: how much an individual's measures differ, as a fraction.
    """

    measures: Measures
    dress: Dress
    habits: tuple[str, ...] = ("stand", "walk", "run", "sit", "wave", "arms_out")
    spread: float = 0.09

    @property
    def poses(self) -> tuple[str, ...]:
        """Those that all bipeds know."""
        return tuple(STANCES)

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts."""
        drawn = str(rng.choice(self.habits))
        measures = vary(self.measures, self.spread, rng)
        return self.dress(measures, skeleton(measures, STANCES[pose or drawn](rng)), rng)


def vary(measures: Measures, spread: float, rng: Rng) -> Measures:
    """Return an individual's measures: lengths each on their own, all girths by one factor."""
    long = {
        name: getattr(measures, name) * float(rng.uniform(1 - spread, 1 + spread))
        for name in ("leg", "torso", "neck", "head", "arm", "hand", "foot", "shoulders", "stoop")
    }
    fat = float(rng.uniform(1 - 1.3 * spread, 1 + 1.8 * spread))
    thick = {n: getattr(measures, n) * fat for n in ("thigh", "calf", "upper_arm", "forearm", "belly")}
    chest, waist, pelvis = (
        (depth * fat, width * (1 + 0.6 * (fat - 1)))
        for depth, width in (measures.chest, measures.waist, measures.pelvis)
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
