"""Beetles: those with a plain back, jaws or a horn, and the ladybird."""

import numpy as np

from normalgan.animals.chain import pitch
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, fuse, roll, tube
from normalgan.animals.insects import eyes, feelers, legs
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def beetle(pose: str, rng: Rng) -> list[Part]:
    """Return a beetle: wing cases with a seam, a shield, and jaws or a horn on some."""
    f = factors(rng, 0.15, "long", "wide", "high", "legs")
    long, wide, high = 0.40 * f["long"], 0.25 * f["wide"], 0.19 * f["high"]
    front = -0.12 + long
    case = ball([-0.14, 0.02, 0], [long, high, wide])
    seam = [
        [-0.14 + long * x, 0.02 + high * np.sqrt(1 - x * x) + 0.008, 0] for x in np.linspace(-0.93, 0.8, 12)
    ]
    lines = [
        [
            [
                -0.14 + 0.9 * long * x,
                0.02 + 0.995 * high * np.sqrt(1 - x * x) * 0.85,
                0.53 * wide * np.sqrt(1 - x * x),
            ]
            for x in np.linspace(-0.85, 0.75, 12)
        ]
    ]
    parts = [
        fuse(case),
        fuse(tube(seam, 0.014), blend=0.01, carve=True),
        fuse(ball([front - 0.03, 0.01, 0], [0.16, 0.82 * high, 0.82 * wide]), blend=0.008),
        fuse(ball([front + 0.14, -0.02, 0], [0.10, 0.09, 0.115]), blend=0.015),
        eyes([front + 0.17, 0.0, 0.10], 0.034),
        legs(
            (
                (front - 0.08, 0.6 * wide, 42, 0.36 * f["legs"]),
                (-0.10, 0.7 * wide, 92, 0.38 * f["legs"]),
                (-0.24, 0.6 * wide, 138, 0.42 * f["legs"]),
            ),
            pose,
            rng,
            0.20,
            0.032,
            1.22,
            -0.07,
        ),
    ]
    if rng.uniform() < 0.5:
        parts.append(fuse(*both(*(tube(line, 0.01) for line in lines)), blend=0.01, carve=True))
    kind = str(rng.choice(("plain", "stag", "horn")))
    nose = front + 0.20
    if kind == "stag":
        jaw = [
            [nose, -0.03, 0.05],
            [nose + 0.13, -0.02, 0.15],
            [nose + 0.30, 0.02, 0.14],
            [nose + 0.38, 0.03, 0.03],
        ]
        prong = [[nose + 0.2, 0.0, 0.15], [nose + 0.24, 0.0, 0.06]]
        parts.append(
            fuse(*both(tube(jaw, [0.045, 0.038, 0.03, 0.018]), tube(prong, [0.03, 0.015])), blend=0.01)
        )
    elif kind == "horn":
        tip = float(rng.uniform(0.22, 0.36))
        horn = [[nose - 0.08, 0.0, 0], [nose + 0.05, 0.10, 0], [nose + 0.09, 0.7 * tip, 0], [nose, tip, 0]]
        parts.append(fuse(tube(horn, [0.06, 0.045, 0.035, 0.016]), blend=0.02))
    ends = [[0.10, 0.05, 0.10], [0.16, 0.05, 0.22]]
    parts.append(feelers([nose - 0.02, 0.02, 0.06], ends, 0.017, club=1.6))
    return parts


def ladybird(pose: str, rng: Rng) -> list[Part]:
    """Return a ladybird: a dome with spots that stand out a little."""
    f = factors(rng, 0.1, "long", "high", "legs", "spots")
    long, high, wide = 0.42 * f["long"], 0.30 * f["high"], 0.37
    radii = np.array([long, high, wide])
    parts = [
        fuse(ball([0, 0, 0], radii)),
        fuse(
            tube(
                [[long * x, high * np.sqrt(1 - x * x) + 0.006, 0] for x in np.linspace(-0.95, 0.72, 14)],
                0.014,
            ),
            blend=0.01,
            carve=True,
        ),
        fuse(ball([0.88 * long, 0.03, 0], [0.15, 0.17, 0.24]), blend=0.008),
        fuse(ball([0.88 * long + 0.13, -0.01, 0], [0.09, 0.10, 0.13]), blend=0.01),
        eyes([0.88 * long + 0.16, 0.02, 0.105], 0.04),
        feelers([0.88 * long + 0.19, 0.04, 0.05], [[0.07, 0.06, 0.05], [0.14, 0.07, 0.11]], 0.016, 1.5),
    ]
    spots = []
    for along, aside in ((0.42, 0.40), (-0.05, 0.60), (-0.52, 0.42), (-0.02, 0.24)):
        up = np.array([along, 0.0, aside])
        up[1] = np.sqrt(1 - up @ up)
        across, ahead = np.rad2deg(np.arctan2(up[[2, 0]] / [wide, long], up[1] / high))
        lie = roll(-across) @ pitch(-ahead)
        spots.append(ball(up * radii, np.array([0.085, 0.016, 0.085]) * f["spots"], lie))
    parts.append(fuse(*both(*spots), blend=0.012))
    reach = 0.30 * f["legs"]
    rows = ((0.28, 0.22, 40, reach), (0.0, 0.27, 92, reach), (-0.22, 0.22, 140, reach))
    parts.append(legs(rows, pose, rng, 0.24, 0.030, 1.15, -0.1))
    return parts
