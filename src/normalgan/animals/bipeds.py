"""The bipeds' body plan: bones that a pose bends, and the flesh, or the metal, that goes round them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, ClassVar

import numpy as np

from normalgan.animals.bipeds_bones import STANCES, Limb, Measures, Skeleton, skeleton, vary
from normalgan.animals.bipeds_heads import HEADS
from normalgan.animals.bipeds_heads import robot as robot_head
from normalgan.animals.frames import Floats, Frame, spanned
from normalgan.animals.parts import Part, Ripple, ball, block, both, carried, fuse, on_side, tube
from normalgan.animals.plan import Between, PosedPlan, Rng
from normalgan.animals.shapes import Shape, Sweep

__all__ = ["Biped", "Flesh", "Robot"]

_FLAT_HAND = 0.17  # half thickness of a palm, in lengths of the hand


@dataclass(frozen=True)
class Flesh:
    """Makes an animal of a skeleton.

    Args:
        head: human, toon, monkey, gorilla or bear.
        hand: mitt, fingers or paw.
        foot: shoe or paw.
        neck: radius of the neck.
        skirt: share of individuals in a skirt.
        tail: length of the tail; 0 for none.
        coat: fur, or None.
    """

    kind: ClassVar[str] = "flesh"
    head: Annotated[str, tuple(HEADS)]
    hand: Annotated[str, ("mitt", "fingers", "paw")] = "mitt"
    foot: Annotated[str, ("shoe", "paw")] = "shoe"
    neck: float = 0.036
    skirt: float = 0.0
    tail: float = 0.0
    coat: Ripple | None = None

    def parts(self, measures: Measures, bones: Skeleton, rng: Rng) -> list[Part]:
        """Return the parts in the order in which they blend."""
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
class Robot:
    """Makes a machine of boxes, balls and pipes of a skeleton."""

    kind: ClassVar[str] = "robot"

    def parts(self, measures: Measures, bones: Skeleton, rng: Rng) -> list[Part]:
        """Return the parts in the order in which they blend."""
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

        def leg(limb: Limb) -> list[Shape]:
            return [*_pipes(limb, measures.thigh, measures.calf, edge, boxy), *_boot(limb, measures, edge)]

        def arm(limb: Limb) -> list[Shape]:
            shoulder = tube([[0, 0, 0], limb.points[0]], 0.8 * measures.upper_arm)
            bones = _pipes(limb, measures.upper_arm, measures.forearm, edge, boxy)
            return [*bones, *_claw(limb, measures), shoulder]

        arms = [shape.placed(chest) for shape in _each(bones.arms, arm)]
        parts.append(fuse(*_each(bones.legs, leg), *arms))
        return parts + carried(robot_head(rng), bones.skull, measures.head)


@dataclass(frozen=True)
class Biped(PosedPlan):
    """A kind that goes on two legs.

    Args:
        habits: the poses it is seen in; one named twice is drawn twice as often.
        body: what goes round the bones.
        measures: of the average individual.
        spread: how much an individual's measures differ, as a fraction, at most a half.
    """

    habits: tuple[Annotated[str, tuple(STANCES)], ...]
    body: Flesh | Robot
    measures: Measures = field(default_factory=Measures)
    spread: Annotated[float, Between(0.0, 0.5)] = 0.09

    @property
    def poses(self) -> tuple[str, ...]:
        """Those that all bipeds know."""
        return tuple(STANCES)

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of one individual in a pose."""
        measures = vary(self.measures, self.spread, rng)
        return self.body.parts(measures, skeleton(measures, STANCES[pose](rng)), rng)


def _each(limbs: tuple[Limb, Limb], shapes: Callable[[Limb], list[Shape]]) -> list[Shape]:
    """Return what goes round the right limb, and the images of what goes round the left."""
    sides = zip((True, False), limbs, strict=True)
    return [on_side(shape, right) for right, limb in sides for shape in shapes(limb)]


def _trunk(measures: Measures, bones: Skeleton) -> Sweep:
    """Return the trunk, from the crotch to the base of the neck."""
    pelvis, waist, chest = (
        np.array([girth.half_depth, girth.half_width])
        for girth in (measures.pelvis, measures.waist, measures.chest)
    )
    rows = np.array([0.6 * pelvis, pelvis, waist, chest, 0.8 * chest, 0.45 * chest])
    points = bones.spine.copy()
    points[-1] = (points[-1] + points[-2]) / 2
    return tube(points, rows[:, 0], rows[:, 1], side=bones.turns[:, :, 2])


def _belly(measures: Measures, bones: Skeleton) -> Shape:
    at, turn = (bones.spine[1] + 1.4 * bones.spine[2]) / 2.4, bones.turns[2]
    size = np.array([measures.waist.half_depth, 0.40 * measures.torso, 1.02 * measures.waist.half_width])
    return ball(at + turn @ np.array([measures.belly, 0.0, 0.0]), size, turn)


def _leg(measures: Measures, limb: Limb) -> list[Shape]:
    hip, knee, ankle = limb.points
    thigh, calf = measures.thigh, measures.calf
    shin = limb.end.origin - knee
    behind = np.cross([0.0, 0.0, 1.0], shin / np.linalg.norm(shin)) * -0.3 * calf
    rows = [hip, hip * 0.6 + knee * 0.4, knee, knee * 0.68 + ankle * 0.32 + behind, ankle]
    return [tube(rows, [1.12 * thigh, thigh, 0.5 * (thigh + calf) * 0.9, calf, 0.62 * calf])]


def _foot(kind: str, measures: Measures, limb: Limb) -> list[Shape]:
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


def _arm(measures: Measures, limb: Limb) -> list[Shape]:
    shoulder, elbow, wrist = limb.points
    upper, fore = measures.upper_arm, measures.forearm
    inner = shoulder + np.array([0.0, -0.1 * upper, -0.6 * upper])
    rows = [inner, shoulder, shoulder * 0.55 + elbow * 0.45, elbow, elbow * 0.7 + wrist * 0.3, wrist]
    radii = [1.15 * upper, 1.2 * upper, upper, 0.55 * (upper + fore) * 0.82, fore, 0.68 * fore]
    return [tube(rows, radii)]


def _hand(kind: str, measures: Measures, limb: Limb) -> list[Shape]:
    """Return a hand whose palm faces the thigh when the arm hangs, its thumb ahead."""
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


def _skirt(measures: Measures, bones: Skeleton) -> Shape:
    """Return a cone about the hips and thighs."""
    waist, hips = bones.spine[2], bones.spine[1]
    hem = hips + np.array([0.0, -0.42 * measures.leg, 0.0])
    hem[0] = np.mean([limb.points[1, 0] for limb in bones.legs])
    depth, width = measures.pelvis.half_depth, measures.pelvis.half_width
    far = max(abs(limb.points[1, 0] - hem[0]) for limb in bones.legs) + measures.thigh
    rows = [waist, hips, hem]
    radii = [measures.waist.half_depth * 1.05, depth * 1.2, max(far, depth) * 1.15]
    return tube(rows, radii, [measures.waist.half_width * 1.05, width * 1.2, width * 1.75], flat=True)


def _tail(length: float, bones: Skeleton, rng: Rng) -> Shape:
    lift, aside = rng.uniform(0.1, 0.7), rng.normal(0, 0.25)
    rows = np.array([[0, 0, 0], [-0.25, -0.08, 0.1], [-0.55, 0.0, 0.4], [-0.72, 0.5, 0.7], [-0.6, 0.95, 1.0]])
    rows = rows * [1.0, lift, aside] * length
    start = Frame(bones.spine[1] + np.array([-0.04, 0.0, 0.0]), np.eye(3))
    return tube(rows, [0.026, 0.022, 0.019, 0.017, 0.016]).placed(start)


def _panel(depth: float, half: float, width: float, rng: Rng) -> list[Shape]:
    """Return what is on the breast: a plate, or knobs."""
    if rng.uniform() < 0.5:
        return [block((depth, -half), [0.014, 0.6 * half, 0.6 * width], 0.01)]
    knobs = both(tube([[x, -0.5 * half, 0.4 * width] for x in (depth - 0.01, depth + 0.014)], 0.02))
    return [*knobs, block((depth, -1.2 * half), [0.012, 0.3 * half, 0.6 * width], 0.01)]


def _pipes(limb: Limb, upper: float, lower: float, edge: float, boxy: bool) -> list[Shape]:
    """Return two boxes or pipes with balls for joints."""
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


def _boot(limb: Limb, measures: Measures, edge: float) -> list[Shape]:
    size = measures.foot
    boot = block((0.22 * size, -0.12 * size), [0.55 * size, 0.2 * size, 0.28 * size], edge)
    return [boot.placed(limb.end)]


def _claw(limb: Limb, measures: Measures) -> list[Shape]:
    """Return a gripper: an open ring."""
    size = measures.hand
    jaw = [[0.0, -0.2, 0], [0.38, -0.4, 0], [0.4, -0.75, 0], [0.16, -1.0, 0]]
    cuff = tube([(0, 0.1), (0, -0.25)], 0.26)
    jaws = [tube(jaw, 0.13), tube(np.array(jaw) * [-1, 1, 1], 0.13), cuff]
    return [shape.placed(limb.end, size) for shape in jaws]


def _upright(axis: Floats) -> Floats:
    """Return a rotation whose second column lies along ``axis`` and whose first points ahead."""
    up = axis / np.linalg.norm(axis)
    aside = np.array([0.0, 1.0, 0.0] if 1 - up[2] ** 2 < 0.3**2 else [0.0, 0.0, 1.0])
    return spanned(np.zeros(3), up, aside).rotation[:, [2, 0, 1]]
