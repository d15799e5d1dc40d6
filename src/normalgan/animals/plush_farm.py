"""Plush toys with snouts and wide mouths: pig, frog, elephant."""

import numpy as np

from normalgan.animals.chain import yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, block, both, fuse, roll, tube
from normalgan.animals.plan import Rng
from normalgan.animals.plush import Toy, buttons, sewn, skull, smile


def pig(pose: str, rng: Rng) -> list[Part]:
    """Return a pig: a flat snout, folded ears, a curl."""
    wide = float(rng.uniform(0.38, 0.48))
    fold = float(rng.uniform(0.2, 0.5))
    tip = [0.2 + 0.35 * fold, 1.12 - 0.3 * fold, 0.84]
    ear = tube([[0.02, 0.58, 0.56], tip], [0.15, 0.05], [0.42, 0.05])
    disc = block([1.62, -0.12, 0], [0.4, 0.48, 0.5], 0.05)
    face = [
        *skull(0.3),
        fuse(
            tube([[0.7, -0.12, 0], [1.22, -0.12, 0]], [0.9 * wide, 0.85 * wide], [1.1 * wide, wide]),
            blend=0.06,
        ),
        fuse(disc, carve=True),  # flat in front; the arms of one that hugs are below
        fuse(*both(ball([1.24, -0.12, 0.42 * wide], [0.12, 0.3 * wide, 0.2 * wide])), blend=0.03, carve=True),
        smile(22, -38, 9, 1.0),
        buttons(34, 22, 0.09),
        fuse(*both(ear), blend=0.05),
    ]
    turn = np.linspace(0, 3.2 * np.pi, 14)
    curl = np.column_stack([-0.22 - 0.011 * turn, 0.27 + 0.05 * np.sin(turn), 0.05 * np.cos(turn) - 0.05])
    body = sewn(Toy(belly=(0.28, 0.29, 0.29), head=0.26), face, pose, rng)
    return [*body, fuse(tube(curl, 0.022), blend=0.01)]


def frog(pose: str, rng: Rng) -> list[Part]:
    """Return a frog: eyes on top, a mouth from ear to ear."""
    size = float(rng.uniform(0.30, 0.40))
    face = [
        fuse(ball([0, 0, 0], [0.98, 0.78, 1.15]), blend=0.05),
        fuse(*both(ball([0.30, 0.66, 0.55], size)), blend=0.08),
        fuse(*both(ball([0.30 + 0.8 * size, 0.72, 0.62], 0.42 * size)), blend=0.02),
        smile(62, -10, 12, 0.955),
    ]
    return sewn(Toy(belly=(0.26, 0.25, 0.28), head=0.29, limbs=0.85, arms=1.15, hands=True), face, pose, rng)


def elephant(pose: str, rng: Rng) -> list[Part]:
    """Return an elephant: a trunk, great ears, tusks on some."""
    ear, lift = float(rng.uniform(0.85, 1.2)), float(rng.uniform(0.0, 1.0))
    trunk = [
        [0.75, -0.1, 0],
        [1.25, -0.35, 0],
        [1.45, -0.85 + 0.4 * lift, 0],
        [1.75, -1.0 + 0.9 * lift, 0],
        [1.98, -0.9 + 1.25 * lift, 0],
    ]
    flap = ball([-0.1, 0.12, 1.0 + 0.55 * ear], np.array([0.15, 0.80, 0.72]) * ear, yaw(-22) @ roll(12))
    face = [
        *skull(),
        fuse(tube(trunk, [0.36, 0.28, 0.21, 0.17, 0.16]), blend=0.12),
        buttons(36, 16, 0.09),
        fuse(*both(flap), blend=0.10),
        fuse(
            *both(ball([0.10, 0.08, 1.02 + 0.6 * ear], np.array([0.13, 0.5, 0.45]) * ear, yaw(-22))),
            blend=0.1,
            carve=True,
        ),
    ]
    if rng.uniform() < 0.5:
        tusk = tube([[0.75, -0.42, 0.34], [1.1, -0.6, 0.40], [1.3, -0.5, 0.38]], [0.12, 0.09, 0.04])
        face.append(fuse(*both(tusk), blend=0.03))
    tail = tube([[-0.2, 0.22, 0], [-0.36, 0.2, 0.02], [-0.44, 0.06, 0.03]], [0.035, 0.028, 0.04])
    body = sewn(Toy(belly=(0.29, 0.31, 0.29), limbs=1.25), face, pose, rng)
    return [*body, fuse(tail, blend=0.02)]
