"""Insects that hum: bee and fly."""

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.forms import ball, fuse, tube
from normalgan.animals.insects import eyes, feelers, held, legs, ringed, wing
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors

Outline = tuple[tuple[float, float], ...]
BLADE: Outline = (
    (-0.03, 0.02),
    (0.2, 0.07),
    (0.5, 0.07),
    (0.66, -0.02),
    (0.58, -0.14),
    (0.3, -0.16),
    (0.05, -0.06),
)


def bee(pose: str, rng: Rng) -> list[Part]:
    """Return a bee or bumblebee: furry breast, ringed abdomen, two pairs of wings."""
    f = factors(rng, 0.14, "belly", "head", "wings", "breast")
    belly, breast = 0.20 * f["belly"], 0.19 * f["breast"]
    raised, back = held(pose, rng, (12, 50), (0, 25), (8, 20), (48, 66))
    span = np.array(BLADE) * f["wings"]
    rear = [[-0.12, 0.0, 0], [-0.30, 0.0, 0], [-0.50, -0.06, 0], [-0.66, -0.16, 0]]
    parts = [
        fuse(ball([0.07, 0.02, 0], [1.1 * breast, breast, breast]), ripple=(0.008, 0.06)),
        fuse(ringed(rear, [0.55 * belly, belly, 0.85 * belly, 0.2 * belly], 5, 0.13), blend=0.03),
        fuse(ball([0.31, -0.02, 0], [0.12, 0.15 * f["head"], 0.16 * f["head"]]), blend=0.02),
        eyes([0.33, 0.0, 0.13 * f["head"]], [0.07, 0.10, 0.055]),
        feelers([0.41, 0.05, 0.04], [[0.08, 0.08, 0.05], [0.2, 0.06, 0.1]], 0.017),
        legs(
            ((0.15, 0.09, 50, 0.28), (0.05, 0.1, 95, 0.30), (-0.04, 0.09, 140, 0.36)),
            pose,
            rng,
            0.30,
            0.030,
            1.2,
            -0.1,
        ),
    ]
    fore = wing([0.08, 0.8 * breast, 0.07], [(a, b) for a, b in span], raised, back, 0.013)
    hind = wing([-0.02, 0.75 * breast, 0.07], [(a, b) for a, b in 0.7 * span], raised - 8, back + 18, 0.013)
    return [*parts, fuse(*fore, *hind, blend=0.012)]


def fly(pose: str, rng: Rng) -> list[Part]:
    """Return a fly: great eyes, short feelers, one pair of wings."""
    f = factors(rng, 0.14, "belly", "eyes", "wings")
    raised, back = held(pose, rng, (10, 45), (0, 25), (8, 18), (52, 72))
    size = 0.125 * f["eyes"]
    return [
        fuse(ball([0.05, 0.03, 0], [0.22, 0.19, 0.19])),
        fuse(
            ringed(
                [[-0.1, 0.02, 0], [-0.26, 0.01, 0], [-0.42, -0.04, 0], [-0.55, -0.10, 0]],
                np.array([0.14, 0.19, 0.15, 0.04]) * f["belly"],
                4,
                0.09,
            ),
            blend=0.03,
        ),
        fuse(ball([0.30, 0.03, 0], [0.11, 0.13, 0.14]), blend=0.02),
        eyes([0.32, 0.05, 0.115], [0.8 * size, 1.1 * size, 0.75 * size], 25),
        fuse(
            tube([[0.34, -0.05, 0], [0.37, -0.13, 0]], [0.035, 0.026]),
            ball([0.375, -0.14, 0], 0.034),
            blend=0.01,
        ),
        feelers([0.40, 0.06, 0.03], [[0.05, 0.03, 0.02], [0.09, 0.0, 0.04]], 0.018),
        legs(
            ((0.15, 0.1, 48, 0.34), (0.05, 0.1, 95, 0.36), (-0.05, 0.1, 140, 0.42)),
            pose,
            rng,
            0.30,
            0.024,
            1.25,
            -0.08,
        ),
        fuse(
            *wing(
                [0.03, 0.17, 0.08],
                [(a, b) for a, b in np.array(BLADE) * [1.0, 1.35] * f["wings"]],
                raised,
                back,
                0.013,
            ),
            blend=0.012,
        ),
    ]
