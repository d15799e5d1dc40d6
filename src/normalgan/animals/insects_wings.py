"""Insects that are mostly wings: butterfly and dragonfly."""

import numpy as np

from normalgan.animals.chain import Frame, pitch
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, carried, fuse, tube
from normalgan.animals.insects import eyes, feelers, held, legs, ringed, wing
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors

Outline = tuple[tuple[float, float], ...]
LONG: Outline = (
    (-0.04, 0.02),
    (0.3, 0.05),
    (0.75, 0.06),
    (0.92, 0.0),
    (0.8, -0.09),
    (0.35, -0.1),
    (0.05, -0.05),
)
FORE: Outline = (
    (-0.04, 0.02),
    (0.35, 0.32),
    (0.72, 0.48),
    (0.80, 0.36),
    (0.66, 0.06),
    (0.4, -0.10),
    (0.08, -0.08),
)
HIND: Outline = (
    (-0.04, 0.05),
    (0.35, 0.06),
    (0.56, -0.10),
    (0.54, -0.36),
    (0.34, -0.52),
    (0.14, -0.40),
    (0.03, -0.12),
)


def butterfly(pose: str, rng: Rng) -> list[Part]:
    """Return a butterfly, its wings spread or folded over the back."""
    f = factors(rng, 0.18, "fore", "hind", "deep", "slim")
    raised, back = held(pose, rng, (8, 52), (-8, 10), (66, 80), (-4, 8))
    tilt = float(rng.uniform(15, 65)) if pose == "fly" else float(rng.uniform(0, 15))
    fore, hind = np.array(FORE) * [f["fore"], f["fore"] * f["deep"]], np.array(HIND) * f["hind"]
    if rng.uniform() < 0.4:  # a swallowtail
        hind[4] = [0.40, -0.80 * f["hind"]]
    slim = 0.052 * f["slim"]
    wings = [
        *wing([0.06, 0.03, 0.025], [(a, b) for a, b in fore], raised, back, 0.016, 0.15),
        *wing([-0.04, 0.03, 0.025], [(a, b) for a, b in hind], raised - 3, back, 0.016, 0.15),
    ]
    parts = [
        fuse(tube([[-0.06, 0, 0], [0.05, 0.01, 0], [0.15, 0, 0]], [1.2 * slim, 1.5 * slim, 1.1 * slim])),
        fuse(
            ringed(
                [[-0.04, 0, 0], [-0.2, 0.0, 0], [-0.44, -0.05, 0]], [slim, 1.15 * slim, 0.5 * slim], 5, 0.1
            ),
            blend=0.02,
        ),
        fuse(ball([0.21, 0.01, 0], 1.25 * slim), blend=0.01),
        eyes([0.235, 0.02, 0.045], 0.032),
        feelers([0.25, 0.03, 0.02], [[0.14, 0.07, 0.07], [0.30, 0.10, 0.15]], 0.018, 1.9),
        fuse(*wings, blend=0.012),
        legs(
            ((0.09, 0.035, 55, 0.15), (0.04, 0.035, 95, 0.16), (-0.01, 0.035, 130, 0.17)),
            "fly" if pose == "fly" else "stand",
            rng,
            0.17,
            0.019,
            1.12,
            -0.02,
        ),
    ]
    return carried(parts, Frame(np.zeros(3), pitch(tilt)))


def dragonfly(pose: str, rng: Rng) -> list[Part]:
    """Return a dragonfly: a long rod of a tail, four long wings held out."""
    f = factors(rng, 0.13, "tail", "wings", "eyes", "breast")
    raised = float(rng.uniform(-5, 30)) if pose == "fly" else float(rng.uniform(-4, 8))
    droop, thin = float(rng.uniform(-0.1, 0.12)), 0.042
    end = -0.20 - 0.75 * f["tail"]
    size = 0.085 * f["eyes"]
    wings = [(a, b) for a, b in np.array(LONG) * [0.85, 1.35] * f["wings"]]
    return [
        fuse(ball([0.03, 0.03, 0], np.array([0.19, 0.13, 0.11]) * f["breast"], pitch(-12))),
        fuse(
            ringed(
                [[-0.08, 0.01, 0], [-0.4, 0.5 * droop, 0], [end, droop, 0]], [1.4 * thin, thin, thin], 8, 0.16
            ),
            blend=0.03,
        ),
        fuse(ball([0.25, 0.02, 0], [0.08, 0.09, 0.09]), blend=0.02),
        eyes([0.27, 0.045, 0.06], [0.9 * size, size, 0.9 * size]),
        fuse(*wing([0.08, 0.13, 0.04], wings, raised, 2, 0.014), blend=0.012),
        fuse(*wing([-0.06, 0.12, 0.04], wings, raised + 4, 14, 0.014), blend=0.012),
        legs(
            ((0.14, 0.05, 45, 0.22), (0.07, 0.06, 85, 0.22), (0.0, 0.06, 125, 0.24)),
            pose,
            rng,
            0.24,
            0.020,
            1.2,
            -0.05,
        ),
    ]
