"""Plush toys that have no arms to sew on: penguin, octopus."""

import numpy as np

from normalgan.animals.chain import pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, by, fuse, roll, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def penguin(pose: str, rng: Rng) -> list[Part]:
    """Return a penguin: an egg with a beak, flippers and flat feet."""
    f = factors(rng, 0.14, "fat", "tall", "head", "beak", "flipper")
    fat, tall, head = 0.30 * f["fat"], 0.42 * f["tall"], 0.26 * f["head"]
    middle = 2 * tall + 0.35 * head
    out = {"cheer": 62.0, "hug": 24.0}.get(pose, float(rng.uniform(12, 34)))
    swing = 40.0 if pose == "hug" else 0.0
    long = 0.44 * f["flipper"]
    turn = roll(out) @ pitch(swing)
    shoulder = np.array([0.0, 1.5 * tall, 0.68 * fat])
    rows = np.array([[0, 0.04, 0], [0, -0.5 * long, 0.02], [-0.03, -long, 0.0]]) @ turn.T + shoulder
    flipper = tube(rows, [0.045, 0.05, 0.03], [0.11, 0.12, 0.05], turn @ [1.0, 0, 0])
    nose = 0.06 + 0.95 * head
    beak = tube(
        [[nose - 0.08, middle, 0], [nose + 0.14 * f["beak"], middle - 0.03, 0]], [0.085, 0.015], [0.10, 0.02]
    )
    feet = both(ball([0.13, 0.02, 0.14], [0.17, 0.045, 0.11], yaw(-18)))
    if pose == "sit":
        feet = both(ball([0.86 * fat, 0.11, 0.15], [0.06, 0.15, 0.11], yaw(-18)))
    eye = [0.06 + 0.82 * head, middle + 0.30 * head, 0.47 * head]
    parts = [
        fuse(ball([0, tall, 0], [0.92 * fat, tall, fat])),
        fuse(ball([0.03, middle, 0], [head, 0.95 * head, 1.02 * head]), blend=0.09),
        fuse(ball([0.12 * fat, 0.92 * tall, 0], [0.88 * fat, 0.8 * tall, 0.80 * fat]), blend=0.008),
        fuse(*both(flipper), blend=0.03),
        fuse(beak, blend=0.015),
        fuse(*both(ball(eye, 0.032)), blend=0.006),
        fuse(*feet, blend=0.015),
        fuse(
            tube([[-0.8 * fat, 0.25 * tall, 0], [-1.12 * fat, 0.08 * tall, 0]], [0.08, 0.03], [0.11, 0.06]),
            blend=0.05,
        ),
    ]
    if rng.uniform() < 0.4:
        parts.append(
            fuse(ball([-0.01, middle + 0.85 * head, 0], [0.8 * head, 0.5 * head, 0.8 * head]), blend=0.01)
        )
        parts.append(fuse(ball([-0.02, middle + 1.45 * head, 0], 0.32 * head), blend=0.01))
    return parts


def octopus(pose: str, rng: Rng) -> list[Part]:
    """Return an octopus: a bulb on eight arms that end in curls."""
    f = factors(rng, 0.14, "tall", "wide", "arms")
    tall, wide = 0.42 * f["tall"], 0.36 * f["wide"]
    reach, thick = 0.50 * f["arms"], float(rng.uniform(0.075, 0.10))
    raised = {"cheer": 0.30, "hug": 0.14}.get(pose, 0.0)
    arms = []
    for i in range(8):
        turn = yaw(22.5 + 45 * i + float(rng.normal(0, 5)))
        curl = float(rng.uniform(0.02, 0.16)) + raised * float(rng.uniform(0.5, 1.2))
        side = float(rng.choice((-1, 1))) * float(rng.uniform(0.0, 0.14))
        rows = [
            [0.1, 0.22, 0],
            [0.28, 0.10, 0],
            [0.28 + 0.55 * reach, thick, side],
            [0.28 + reach, thick + 0.4 * curl, 1.6 * side],
            [0.22 + reach, thick + 1.2 * curl, 2.2 * side],
        ]
        arms.append(tube(np.array(rows) @ turn.T, np.array([1.2, 1.1, 0.9, 0.7, 0.5]) * thick))
    eye = np.array([0.80 * wide, 0.32 + 0.62 * tall, 0.42 * wide])
    mouth = [
        [0.93 * wide * np.cos(a), 0.30 + 0.32 * tall + 0.05 * a * a, 0.93 * wide * np.sin(a)]
        for a in np.linspace(-0.35, 0.35, 7)
    ]
    return [
        fuse(ball([-0.02, 0.28 + tall, 0], [wide, tall, 1.02 * wide])),
        fuse(ball([0, 0.24, 0], [0.30, 0.20, 0.30]), blend=0.15),
        fuse(*arms, blend=0.06),
        fuse(*both(ball(eye, 0.085)), blend=0.02),
        fuse(*both(ball(by(eye, 0.07, 0.01, 0.01), 0.04)), blend=0.006),
        fuse(tube(mouth, 0.014), blend=0.012, carve=True),
    ]
