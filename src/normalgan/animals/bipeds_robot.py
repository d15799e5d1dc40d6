"""A biped made of boxes, balls and pipes."""

import numpy as np

from normalgan.animals.bipeds import Limb, Measures, Skeleton
from normalgan.animals.bipeds_heads import robot as robot_head
from normalgan.animals.field import Part
from normalgan.animals.forms import (
    Shape,
    ball,
    block,
    both,
    carried,
    fuse,
    mirrored,
    moved,
    tube,
)
from normalgan.animals.plan import Rng
from normalgan.animals.sweep import Floats


def robot(measures: Measures, bones: Skeleton, rng: Rng) -> list[Part]:
    """Return the parts of a robot."""
    edge = float(rng.uniform(0.012, 0.04))
    boxy = bool(rng.uniform() < 0.5)
    depth, width = measures.chest
    chest = bones.chest
    half = 0.36 * measures.torso
    middle = chest.place(np.array([0.0, -half, 0.0]))
    parts = [
        fuse(block(middle, [depth, 1.25 * half, width], edge, chest.rotation)),
        fuse(block(bones.spine[1], [measures.pelvis[0], 0.04, measures.pelvis[1]], edge)),
        fuse(tube([bones.spine[1], bones.spine[2], middle], 0.7 * measures.waist[0])),
        fuse(*(moved(one, chest) for one in _panel(depth, half, width, rng))),
        fuse(tube([chest.origin, bones.skull.place(np.array([0.0, 0.1, 0.0]) * measures.head)], 0.035)),
    ]
    limbs: list[Shape] = []
    for i, limb in enumerate(bones.legs):
        leg = [*_pipes(limb, measures.thigh, measures.calf, edge, boxy), *_boot(limb, measures, edge)]
        limbs += leg if i == 0 else [mirrored(shape) for shape in leg]
    for i, limb in enumerate(bones.arms):
        arm = [*_pipes(limb, measures.upper_arm, measures.forearm, edge, boxy), *_claw(limb, measures)]
        arm.append(tube([[0, 0, 0], limb.points[0]], 0.8 * measures.upper_arm))
        limbs += [moved(shape if i == 0 else mirrored(shape), chest) for shape in arm]
    parts.append(fuse(*limbs))
    return parts + carried(robot_head(rng), bones.skull, measures.head)


def _panel(depth: float, half: float, width: float, rng: Rng) -> list[Shape]:
    """Return what is on the breast: a plate, or knobs."""
    if rng.uniform() < 0.5:
        return [block([depth, -half, 0], [0.014, 0.6 * half, 0.6 * width], 0.01)]
    knobs = both(
        tube([[depth - 0.01, -0.5 * half, 0.4 * width], [depth + 0.014, -0.5 * half, 0.4 * width]], 0.02)
    )
    return [*knobs, block([depth, -1.2 * half, 0], [0.012, 0.3 * half, 0.6 * width], 0.01)]


def _pipes(limb: Limb, upper: float, lower: float, edge: float, boxy: bool) -> list[Shape]:
    """Return two boxes or pipes with balls for joints."""
    first, second, third = limb.points
    shapes: list[Shape] = [ball(first, 1.15 * upper), ball(second, 1.12 * lower), ball(third, 0.9 * lower)]
    for start, end, radius in ((first, second, upper), (second, third, lower)):
        if boxy:
            length = float(np.linalg.norm(end - start))
            shapes.append(
                block((start + end) / 2, [radius, 0.42 * length, radius], edge, _upright(start - end))
            )
            shapes.append(tube([start, end], 0.55 * radius))
        else:
            shapes.append(tube([start, end], 0.85 * radius))
    return shapes


def _boot(limb: Limb, measures: Measures, edge: float) -> list[Shape]:
    size = measures.foot
    boot = block([0.22 * size, -0.12 * size, 0], [0.55 * size, 0.2 * size, 0.28 * size], edge)
    return [moved(boot, limb.end)]


def _claw(limb: Limb, measures: Measures) -> list[Shape]:
    """Return a gripper: an open ring."""
    size = measures.hand
    jaw = [[0.0, -0.2, 0], [0.38, -0.4, 0], [0.4, -0.75, 0], [0.16, -1.0, 0]]
    cuff = tube([[0, 0.1, 0], [0, -0.25, 0]], 0.26)
    jaws = [tube(jaw, 0.13), tube(np.array(jaw) * [-1, 1, 1], 0.13), cuff]
    return [moved(shape, limb.end, size) for shape in jaws]


def _upright(axis: Floats) -> Floats:
    """Return a rotation whose second column lies along ``axis`` and whose first points ahead."""
    up = axis / np.linalg.norm(axis)
    right = np.array([0.0, 0.0, 1.0]) - up[2] * up
    if np.linalg.norm(right) < 0.3:
        right = np.array([0.0, 1.0, 0.0]) - up[1] * up
    right /= np.linalg.norm(right)
    return np.column_stack([np.cross(up, right), up, right])
