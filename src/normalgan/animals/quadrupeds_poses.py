"""Poses: joint angles drawn from gaits and habits."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from normalgan.animals.plan import Rng

Angles = tuple[float, float, float, float]


@dataclass(frozen=True)
class Pose:
    """Angles in degrees relative to rest; positive joint angles move the part below forward.

    Args:
        legs: angles of the four joints of right fore, left fore, right hind and left hind leg, from the
            top down.
        stance: whether each of these feet stands on the ground.
        pitch: pitch of the torso, positive with the chest up.
        neck_pitch: pitch of the neck, from 0 to 1, within the range of the species.
        neck_yaw: yaw of the neck, positive to the animal's left.
        head_pitch: pitch of the head, positive with the nose up.
        head_yaw: yaw of the head relative to the neck.
        tail_lift: pitch of the tail, from 0 to 1, within the range of the species.
        tail_swing: yaw of the tail, positive to the left.
        graze: whether the neck is lowered until the muzzle is near the ground.
        sit: whether the animal sits on its folded hind legs.
    """

    legs: tuple[Angles, ...]
    stance: tuple[bool, ...] = (True, True, True, True)
    pitch: float = 0.0
    neck_pitch: float = 0.0
    neck_yaw: float = 0.0
    head_pitch: float = 0.0
    head_yaw: float = 0.0
    tail_lift: float = 0.5
    tail_swing: float = 0.0
    graze: bool = False
    sit: bool = False


@dataclass(frozen=True)
class _Gait:
    """A gait (Hildebrand, "The quadrupedal gaits of vertebrates", 1989).

    Args:
        phases: phases of right fore, left fore, right hind and left hind leg in the cycle, from 0 to 1.
        duty: fraction of the cycle during which a foot is on the ground.
        swing: amplitude of the leg's swing in degrees.
        lift: flexion of the swinging leg in degrees.
        grounded: whether standing feet are moved to the ground, which is false in the leap of a gallop.
    """

    phases: Angles
    duty: float
    swing: float
    lift: float
    grounded: bool = True


_WALK = _Gait((0.75, 0.25, 0.5, 0.0), 0.64, 19.0, 42.0)
_TROT = _Gait((0.0, 0.5, 0.5, 0.0), 0.48, 25.0, 62.0)
_GALLOP = _Gait((0.62, 0.5, 0.12, 0.0), 0.3, 42.0, 70.0, grounded=False)


def _leg(gait: _Gait, phase: float, fore: bool) -> tuple[Angles, bool]:
    phase %= 1.0
    if phase < gait.duty:
        upper = gait.swing * (1 - 2 * phase / gait.duty)
        return (upper, 0.0, 0.0, -upper if gait.grounded else -0.4 * upper), True
    s = (phase - gait.duty) / (1 - gait.duty)
    upper = gait.swing * (2 * s * s * (3 - 2 * s) - 1)
    fold = gait.lift * float(np.sin(np.pi * s) ** 1.3)
    if fore:
        return (upper, 0.55 * fold, -1.25 * fold, -0.6 * fold), False
    return (upper + 0.45 * fold, -0.85 * fold, 0.75 * fold, -0.8 * fold), False


def _going(gait: _Gait, rng: Rng) -> Pose:
    start = rng.uniform()
    gait = replace(gait, swing=gait.swing * rng.uniform(0.75, 1.1), lift=gait.lift * rng.uniform(0.8, 1.15))
    drawn = [_leg(gait, start + phase, fore=i < 2) for i, phase in enumerate(gait.phases)]
    legs = tuple(angles for angles, _ in drawn)
    stance = tuple(down and gait.grounded for _, down in drawn)
    pitch = 7.0 * float(np.sin(2 * np.pi * start)) if not gait.grounded else 0.0
    return replace(_carriage(rng), legs=legs, stance=stance, pitch=pitch)


def _carriage(rng: Rng) -> Pose:
    """Return a random pose of neck, head and tail, with the legs at rest."""
    return Pose(
        4 * ((0.0, 0.0, 0.0, 0.0),),
        neck_pitch=rng.uniform(0, 1),
        neck_yaw=rng.normal(0, 14),
        head_pitch=rng.uniform(-8, 10),
        head_yaw=rng.normal(0, 9),
        tail_lift=rng.uniform(0, 1),
        tail_swing=rng.normal(0, 18),
    )


def _stand(rng: Rng) -> Pose:
    uppers = rng.normal(0, 4, 4).clip(-9, 9)
    return replace(_carriage(rng), legs=tuple((float(a), 0.0, 0.0, -float(a)) for a in uppers))


def _gallop(rng: Rng) -> Pose:
    return replace(_going(_GALLOP, rng), tail_lift=rng.uniform(0.6, 1.0))


def _graze(rng: Rng) -> Pose:
    ahead = rng.uniform(8, 17)
    back = rng.uniform(-9, 0)
    fronts = [(ahead, 0.0, 0.0, -ahead), (back, 0.0, 0.0, -back)]
    first = int(rng.integers(2))
    pose = _stand(rng)
    legs = (fronts[first], fronts[1 - first], pose.legs[2], pose.legs[3])
    return replace(pose, legs=legs, graze=True, neck_yaw=rng.normal(0, 10))


def _sit(rng: Rng) -> Pose:
    front = rng.uniform(-2, 8)
    fold = rng.uniform(-4, 6)
    fore = (front, 0.0, 0.0, -front)
    hind = (62.0 + fold, -102.0, 98.0, -58.0 - fold)
    return replace(_carriage(rng), legs=(fore, fore, hind, hind), sit=True)


POSES: Mapping[str, Callable[[Rng], Pose]] = {
    "stand": _stand,
    "walk": partial(_going, _WALK),
    "trot": partial(_going, _TROT),
    "gallop": _gallop,
    "graze": _graze,
    "sit": _sit,
}


_IN_THE_AIR = (False, False, False, False)


def _lie(rng: Rng) -> Pose:
    """Return a pose on the belly, with stretched forelegs like a dog or folded forelegs like a cow."""
    fold = rng.uniform(-6, 6)
    ahead = (-28.0 + fold, 102.0, 8.0, 0.0)
    under = (44.0 + fold, 22.0, -152.0, -20.0)
    fore = ahead if rng.uniform() < 0.5 else under
    hind = (58.0 + fold, -104.0, 112.0, -8.0)
    return replace(_carriage(rng), legs=(fore, fore, hind, hind), stance=_IN_THE_AIR)


def _rear(rng: Rng) -> Pose:
    fores = [(float(a), float(b), -55.0, -25.0) for a, b in rng.uniform((15, 20), (55, 60), (2, 2))]
    push = rng.uniform(-4, 12)
    hind = (push, -push, 0.0, 0.0)
    stance = (False, False, True, True)
    return replace(
        _carriage(rng), legs=(*fores, hind, hind), stance=stance, pitch=rng.uniform(35, 62), neck_pitch=0.0
    )


def _beg(rng: Rng) -> Pose:
    fores = [(float(a), 65.0, -30.0, -25.0) for a in rng.uniform(-15, 20, 2)]
    fold = rng.uniform(-4, 6)
    hind = (62.0 + fold, -102.0, 98.0, -58.0 - fold)
    return replace(
        _carriage(rng),
        legs=(*fores, hind, hind),
        stance=_IN_THE_AIR,
        pitch=rng.uniform(52, 72),
        neck_pitch=0.0,
    )


def _bow(rng: Rng) -> Pose:
    """Return a pose with the forelegs stretched forward, the chest low and the rump high."""
    ahead = rng.uniform(48, 66)
    fore = (ahead, 12.0, 4.0, 10.0)
    pose = _stand(rng)
    stance = (False, False, True, True)
    return replace(
        pose,
        legs=(fore, fore, *pose.legs[2:]),
        stance=stance,
        pitch=rng.uniform(-30, -18),
        neck_pitch=1.0,
        tail_lift=1.0,
    )


def _leap(rng: Rng) -> Pose:
    fores = [(float(a), float(b), -15.0, -10.0) for a, b in rng.uniform((35, 0), (65, 30), (2, 2))]
    hinds = [(float(a), 10.0, -12.0, -20.0) for a in rng.uniform(-62, -40, 2)]
    return replace(_carriage(rng), legs=(*fores, *hinds), stance=_IN_THE_AIR, pitch=rng.uniform(-12, 25))


def _look_back(rng: Rng) -> Pose:
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    return replace(_stand(rng), neck_yaw=side * rng.uniform(55, 95), head_yaw=side * rng.uniform(15, 45))


POSTURES: Mapping[str, Callable[[Rng], Pose]] = {
    "lie": _lie,
    "rear": _rear,
    "beg": _beg,
    "bow": _bow,
    "leap": _leap,
    "look_back": _look_back,
}
"""Poses that are not a habit of any species and must be requested."""
