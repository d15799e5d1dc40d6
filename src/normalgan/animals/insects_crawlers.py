"""Insects that crawl without cases on their backs: ant, caterpillar."""

import numpy as np

from normalgan.animals.chain import pitch
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, by, fuse, tube
from normalgan.animals.insects import eyes, feelers, legs
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def ant(pose: str, rng: Rng) -> list[Part]:
    """Return an ant: three beads, a waist, elbowed antennae."""
    f = factors(rng, 0.15, "gaster", "head", "legs", "thorax")
    tip = float(rng.uniform(-0.05, 0.08))
    gaster, head = 0.17 * f["gaster"], 0.135 * f["head"]
    middle = -0.26 - 1.25 * gaster
    nose = 0.20 + head
    return [
        fuse(
            tube(
                [[-0.14, 0.0, 0], [0.02, 0.02, 0], [0.17, 0.05, 0]],
                np.array([0.05, 0.085, 0.075]) * f["thorax"],
            )
        ),
        fuse(tube([[-0.30, -0.01, 0], [-0.22, 0.05, 0], [-0.12, 0.0, 0]], [0.03, 0.05, 0.04]), blend=0.03),
        fuse(ball([middle, tip, 0], [1.3 * gaster, gaster, gaster], pitch(-12)), blend=0.03),
        fuse(ball([nose, 0.05, 0], [head * 1.12, 0.78 * head, head], pitch(-30)), blend=0.04),
        fuse(
            *both(
                tube(
                    [[nose + 0.07, -0.02, 0.06], [nose + 0.17, -0.06, 0.07], [nose + 0.20, -0.08, 0.015]],
                    [0.035, 0.028, 0.016],
                )
            ),
            blend=0.01,
        ),
        eyes([nose + 0.03, 0.09, 0.085 * f["head"]], [0.032, 0.03, 0.026]),
        feelers(
            [nose + 0.08, 0.07, 0.04], [[0.10, 0.16, 0.09], [0.27, 0.13, 0.15], [0.38, 0.05, 0.18]], 0.02
        ),
        legs(
            (
                (0.14, 0.055, 48, 0.42 * f["legs"]),
                (0.05, 0.06, 95, 0.44 * f["legs"]),
                (-0.05, 0.055, 142, 0.5 * f["legs"]),
            ),
            pose,
            rng,
            0.24,
            0.027,
            1.3,
        ),
    ]


def caterpillar(pose: str, rng: Rng) -> list[Part]:
    """Return a caterpillar: rings on stumpy legs; one that walks arches its back."""
    rings = int(rng.integers(8, 12))
    arch = float(rng.uniform(0.16, 0.30)) if pose == "walk" else float(rng.uniform(0.0, 0.05))
    fat, sway = float(rng.uniform(0.085, 0.115)), float(rng.uniform(-0.1, 0.1))
    x = np.linspace(-0.6, 0.6, rings)
    y = arch * np.cos(np.pi * x / 1.2) ** 2 * (1 + np.sin(3 * x)) + 0.12 * np.clip(x - 0.3, 0, None)
    z = sway * np.sin(4 * x)
    size = fat * (1 - 0.35 * np.clip(np.abs(x) / 0.6 - 0.6, 0, None))
    beads = [ball([a, b, c], s) for a, b, c, s in zip(x, y, z, size, strict=True)]
    feet = []
    for i, (a, b, c, s) in enumerate(zip(x, y, z, size, strict=True)):
        if (arch < 0.1 or b < 0.35 * arch + 0.02) and 0 < i < rings - 1:
            feet += [
                tube([[a, b, c + 0.5 * s * k], [a, b - 1.15 * s, c + 0.65 * s * k]], 0.032) for k in (1, -1)
            ]
    end = np.array([x[-1] + 0.5 * fat, y[-1] + 0.02, z[-1]])
    # On an arched back beads lie too far apart to touch: a spine holds them together.
    spine = tube(np.stack([x, y, z], axis=1), 0.7 * size)
    parts = [fuse(spine)] + [fuse(one, blend=0.05) for one in beads]
    parts += [fuse(*feet, blend=0.02), fuse(ball(end, 1.05 * fat), blend=0.02)]
    for k in (1, -1):
        horn = tube([by(end, 0.02, 0.08, 0.04 * k), by(end, 0.06, 0.2, 0.09 * k)], 0.018)
        look = end + np.array([0.075, 0.03, 0.055 * k])
        parts.append(fuse(horn, ball(by(end, 0.06, 0.21, 0.09 * k), 0.03), ball(look, 0.032), blend=0.008))
    return parts
