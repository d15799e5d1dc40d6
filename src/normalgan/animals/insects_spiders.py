"""Those with eight legs: spider, scorpion."""

import numpy as np

from normalgan.animals.chain import pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, fuse, tube
from normalgan.animals.insects import eyes, legs, ringed
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def spider(pose: str, rng: Rng) -> list[Part]:
    """Return a spider: two balls, eight legs, palps."""
    f = factors(rng, 0.2, "belly", "legs", "front")
    belly, thick = 0.25 * f["belly"], float(rng.uniform(0.022, 0.04))
    reach = 0.62 * f["legs"]
    coat = (0.005, 0.06) if rng.uniform() < 0.4 else None
    parts = [
        fuse(ball([0.12, 0.01, 0], [0.22, 0.14, 0.18])),
        fuse(
            ball([-0.1 - belly, 0.06, 0], [1.2 * belly, 0.9 * belly, belly], pitch(8)),
            blend=0.03,
            ripple=coat,
        ),
        fuse(ball([0.27, 0.03, 0], [0.10, 0.09, 0.11]), blend=0.05),
        fuse(*both(ball([0.35, 0.07, 0.04], 0.03), ball([0.33, 0.10, 0.085], 0.022)), blend=0.004),
        fuse(
            *both(
                tube([[0.32, -0.02, 0.05], [0.40, -0.07, 0.05], [0.40, -0.15, 0.04]], [0.05, 0.042, 0.015])
            ),
            blend=0.01,
        ),
        fuse(
            *both(tube([[0.27, -0.02, 0.09], [0.41, 0.03, 0.15], [0.50, -0.07, 0.14]], 0.8 * thick)),
            blend=0.01,
        ),
    ]
    azimuths = (28 * f["front"], 68, 108, 150)
    rows = tuple(
        (0.22 - 0.065 * i, 0.10, a, reach * (1.12, 0.95, 0.9, 1.15)[i]) for i, a in enumerate(azimuths)
    )
    parts.append(legs(rows, pose, rng, 0.26, thick, float(rng.uniform(1.3, 1.6))))
    return parts


def scorpion(pose: str, rng: Rng) -> list[Part]:
    """Return a scorpion: pincers ahead, the sting over the back."""
    f = factors(rng, 0.15, "tail", "claw", "legs", "wide")
    curl = np.deg2rad(np.linspace(165, float(rng.uniform(10, 50)), 7))
    radius = 0.27 * f["tail"]
    tail = np.column_stack(
        [-0.36 + radius * np.cos(curl), 0.04 + radius + radius * np.sin(curl) * 1.15, 0 * curl]
    )
    tail = np.vstack([[-0.34, 0.0, 0], [-0.55, 0.04, 0], tail])
    tip = tail[-1] + [0.06, -0.13, 0]
    claw = 0.13 * f["claw"]
    hand = np.array([0.62, 0.0, 0.30])
    arm = [[0.24, 0.0, 0.08], [0.36, 0.06, 0.28], [0.52, 0.02, 0.36], hand.tolist()]
    pincer = yaw(float(rng.uniform(-5, 20)))
    fingers = [
        [[0, 0, 0], [1.0 * claw, 0, s * 0.6 * claw], [2.0 * claw, 0, s * 0.12 * claw + 0.02]] for s in (1, -1)
    ]
    grip = [
        tube(np.array(finger) @ pincer.T + hand, [0.55 * claw, 0.36 * claw, 0.12 * claw])
        for finger in fingers
    ]
    return [
        fuse(
            ringed(
                [[-0.40, 0, 0], [-0.1, 0.01, 0], [0.28, 0, 0]], [0.07, 0.11, 0.09], 7, 0.12, 1.45 * f["wide"]
            )
        ),
        fuse(ringed(tail, np.linspace(0.062, 0.05, len(tail)), 6, 0.3), blend=0.02),
        fuse(ball(tail[-1], 0.068), tube([tail[-1], tip], [0.05, 0.014]), blend=0.01),
        fuse(
            *both(
                tube(arm, [0.04, 0.036, 0.034, 0.04]), ball(hand, [1.2 * claw, 0.7 * claw, 0.8 * claw]), *grip
            ),
            blend=0.01,
        ),
        eyes([0.24, 0.10, 0.03], 0.022),
        legs(
            tuple((0.18 - 0.1 * i, 0.10, a, 0.36 * f["legs"]) for i, a in enumerate((55, 82, 108, 138))),
            pose,
            rng,
            0.15,
            0.026,
            1.3,
        ),
    ]
