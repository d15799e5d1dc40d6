"""Plush toys with muzzles: teddy bear, bunny, cat."""

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, fuse, roll, tube
from normalgan.animals.plan import Rng
from normalgan.animals.plush import Toy, buttons, sewn, skull


def teddy(pose: str, rng: Rng) -> list[Part]:
    """Return a teddy bear."""
    ear, muzzle = float(rng.uniform(0.34, 0.46)), float(rng.uniform(0.85, 1.15))
    at = [0.0, 0.80, 0.72]
    face = [
        *skull(),
        fuse(ball([0.82, -0.26, 0], np.array([0.42, 0.34, 0.42]) * muzzle), blend=0.12),
        fuse(ball([0.84 + 0.40 * muzzle, -0.12, 0], [0.09, 0.10, 0.15]), blend=0.02),
        fuse(tube([[1.24 * muzzle, -0.22, 0], [1.18 * muzzle, -0.42, 0]], 0.03), blend=0.02, carve=True),
        buttons(26, 16, 0.10),
        fuse(*both(ball(at, [0.17, ear, ear])), blend=0.08),
        fuse(*both(ball([0.15, 0.84, 0.76], [0.14, 0.6 * ear, 0.6 * ear])), blend=0.06, carve=True),
    ]
    return [*sewn(Toy(hands=True), face, pose, rng), *_button(rng)]


def _button(rng: Rng) -> list[Part]:
    """Return a stub of a tail."""
    return [fuse(ball([-0.24, 0.10, 0], float(rng.uniform(0.06, 0.09))), blend=0.03)]


def bunny(pose: str, rng: Rng) -> list[Part]:
    """Return a bunny, an ear flopped on some."""
    long = float(rng.uniform(1.0, 1.6))
    flop = [rng.uniform() < 0.3 for _ in range(2)]
    ears = []
    for sign, bent in zip((1.0, -1.0), flop, strict=True):
        top = [-0.15, 0.8 + long, 0.6 * sign]
        rows = [[-0.05, 0.7, 0.34 * sign], [-0.1, 0.8 + 0.5 * long, 0.46 * sign], top]
        if bent:
            rows = [*rows[:2], [0.05, 0.85 + 0.72 * long, 0.75 * sign], [0.3, 0.7 + 0.45 * long, 1.1 * sign]]
        ears.append(tube(rows, 0.12, [0.2, 0.3, 0.26, 0.16][: len(rows)]))
    face = [
        *skull(0.32),
        fuse(ball([0.92, -0.25, 0], [0.22, 0.2, 0.3]), blend=0.12),
        fuse(ball([1.12, -0.12, 0], [0.07, 0.07, 0.11]), blend=0.02),
        buttons(30, 12, 0.10),
        fuse(*ears, blend=0.06),
    ]
    tail = ball([-0.27, 0.13, 0], float(rng.uniform(0.09, 0.13)))
    return [*sewn(Toy(belly=(0.24, 0.31, 0.25), limbs=0.95), face, pose, rng), fuse(tail, blend=0.02)]


def cat(pose: str, rng: Rng) -> list[Part]:
    """Return a cat with pointed ears and a long tail."""
    ear = float(rng.uniform(0.9, 1.2))
    prick = tube([[-0.02, 0.55, 0.52], [-0.05, 0.55 + 0.72 * ear, 0.80]], [0.16, 0.05], [0.42, 0.05])
    face = [
        *skull(0.3),
        fuse(*both(ball([0.95, -0.28, 0.13], [0.16, 0.15, 0.19])), blend=0.05),
        fuse(ball([1.08, -0.14, 0], [0.06, 0.06, 0.09]), blend=0.02),
        buttons(30, 14, 0.115),
        fuse(*both(prick), blend=0.06),
        fuse(*both(ball([0.16, 0.86, 0.66], [0.13, 0.26, 0.17], roll(-20))), blend=0.05, carve=True),
    ]
    up, aside = float(rng.uniform(0.1, 0.5)), float(rng.choice((-1, 1)))
    tail = [
        [-0.15, 0.12, 0],
        [-0.38, 0.11, 0.08 * aside],
        [-0.48, 0.2 + 0.5 * up, 0.16 * aside],
        [-0.40, 0.25 + up, 0.2 * aside],
    ]
    return [*sewn(Toy(belly=(0.23, 0.29, 0.23)), face, pose, rng), fuse(tube(tail, 0.062), blend=0.03)]
