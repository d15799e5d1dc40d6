"""Poses of those that stand on two legs: joint angles, drawn."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from normalgan.animals.plan import Rng


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
    return replace(stance, nod=float(rng.uniform(-8, 8)), turn=float(rng.normal(0, 14)))


def _arm(rng: Rng) -> Arm:
    return Arm(
        float(rng.uniform(-12, 14)),
        float(rng.uniform(12, 28)),
        float(rng.uniform(0, 30)),
        float(rng.uniform(8, 35)),
    )


def _stand(rng: Rng) -> Stance:
    out = float(rng.uniform(4, 11))
    legs = (Leg(float(rng.uniform(-2, 6)), out), Leg(float(rng.uniform(-6, 3)), out))
    return _head(Stance(legs, (_arm(rng), _arm(rng)), lean=float(rng.uniform(-2, 5))), rng)


def _stride(rng: Rng, swing: float, knee: float, elbow: float, lean: float) -> Stance:
    wide = swing * float(rng.uniform(0.75, 1.1))
    ahead = Leg(wide, 2.0, 0.25 * knee, 10.0)
    behind = Leg(-0.7 * wide, 2.0, knee, -25.0)
    with_leg, against = Arm(-wide, 12.0, 10.0, elbow * 0.7), Arm(wide, 12.0, 10.0, elbow)
    stance = Stance((ahead, behind), (with_leg, against), lean, float(rng.uniform(4, 14)))
    if rng.uniform() < 0.5:
        stance = replace(stance, legs=(behind, ahead), arms=(against, with_leg), twist=-stance.twist)
    return _head(stance, rng)


def _walk(rng: Rng) -> Stance:
    return _stride(rng, 28.0, 26.0, 25.0, 4.0)


def _run(rng: Rng) -> Stance:
    return _stride(rng, 52.0, 85.0, 90.0, 14.0)


def _sit(rng: Rng) -> Stance:
    """On a bench nobody sees, or on the ground with the legs ahead."""
    ground = rng.uniform() < 0.5
    knee, out = (float(rng.uniform(5, 30)), 16.0) if ground else (float(rng.uniform(75, 95)), 9.0)
    legs = tuple(Leg(88.0, out + float(rng.uniform(-3, 6)), knee, 0.0) for _ in range(2))
    arms = tuple(Arm(float(rng.uniform(20, 38)), 14.0, 15.0, float(rng.uniform(25, 60))) for _ in range(2))
    return _head(Stance((legs[0], legs[1]), (arms[0], arms[1]), lean=float(rng.uniform(-8, 6))), rng)


def _wave(rng: Rng) -> Stance:
    stance = _stand(rng)
    up = Arm(0.0, float(rng.uniform(80, 115)), -90.0, float(rng.uniform(30, 85)))
    hand = int(rng.integers(2))
    return replace(stance, arms=(up, stance.arms[1]) if hand else (stance.arms[0], up))


def _arms_out(rng: Rng) -> Stance:
    """Both arms stretched sideways, or raised."""
    stance = _stand(rng)
    out, elbow = float(rng.uniform(62, 140)), float(rng.uniform(0, 20))
    twist = -90.0 if out > 100 else 0.0
    return replace(stance, arms=(Arm(0.0, out, twist, elbow), Arm(0.0, out, twist, elbow)))


STANCES: Mapping[str, Callable[[Rng], Stance]] = {
    "stand": _stand,
    "walk": _walk,
    "run": _run,
    "sit": _sit,
    "wave": _wave,
    "arms_out": _arms_out,
}
