"""The plush dragon."""

import numpy as np

from normalgan.animals.chain import Frame, pitch
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, carried, fuse, tube
from normalgan.animals.insects import wing
from normalgan.animals.plan import Rng
from normalgan.animals.plush import Toy, buttons, sewn, skull


def dragon(pose: str, rng: Rng) -> list[Part]:
    """Return a dragon: snout, horns, a comb down the back, small wings, a tail with a barb."""
    horn, snout = float(rng.uniform(0.5, 0.95)), float(rng.uniform(0.85, 1.15))
    prongs = tube(
        [[-0.15, 0.72, 0.42], [-0.35, 0.95 + 0.5 * horn, 0.55], [-0.40, 1.0 + horn, 0.5]], [0.17, 0.11, 0.03]
    )
    face = [
        *skull(0.2),
        fuse(tube([[0.5, -0.25, 0], [0.6 + 0.62 * snout, -0.28, 0]], [0.46, 0.36], [0.52, 0.46]), blend=0.12),
        fuse(*both(ball([0.78 + 0.72 * snout, -0.02, 0.2], 0.12)), blend=0.06),
        fuse(*both(ball([0.93 + 0.72 * snout, 0.02, 0.21], 0.06)), blend=0.03, carve=True),
        buttons(34, 24, 0.15),
        fuse(*both(prongs), blend=0.06),
        fuse(
            *both(tube([[-0.1, 0.25, 0.95], [-0.3, 0.4, 1.45]], [0.08, 0.03], [0.26, 0.03], [0, 1, 0])),
            blend=0.05,
        ),
        *(
            fuse(
                tube(
                    [[-0.55 * k, 0.95 - 0.35 * k, 0], [-0.75 * k - 0.12, 1.35 - 0.5 * k, 0]],
                    [0.2, 0.03],
                    0.09,
                ),
                blend=0.03,
            )
            for k in (0.35, 0.9)
        ),
    ]
    parts = sewn(Toy(belly=(0.26, 0.30, 0.26), head=0.25, limbs=0.95), face, pose, rng)
    aside = float(rng.choice((-1, 1)))
    tail = np.array([[-0.1, 0.16, 0], [-0.34, 0.10, 0.02], [-0.55, 0.09, 0.10], [-0.70, 0.13, 0.24]]) * [
        1,
        1,
        aside,
    ]
    way = (tail[-1] - tail[-2]) / np.linalg.norm(tail[-1] - tail[-2])
    parts.append(fuse(tube(tail, [0.16, 0.12, 0.075, 0.04]), blend=0.06))
    parts.append(
        fuse(tube([tail[-1], tail[-1] + 0.14 * way], [0.03, 0.025], [0.1, 0.02], [0, 1, 0]), blend=0.01)
    )
    comb = []
    for i in range(5):
        t = np.deg2rad(110 + 28 * i)
        out = np.array([np.cos(t), np.sin(t), 0.0])
        at = np.array([0.0, 0.30, 0]) + out * [0.22, 0.27, 0]
        comb.append(tube([at, at + 0.15 * out], [0.07, 0.012], 0.035))
    parts.append(fuse(*comb, blend=0.02))
    span = float(rng.uniform(0.8, 1.2))
    bat = (
        np.array(
            [
                [-0.05, 0.03],
                [0.16, 0.16],
                [0.40, 0.14],
                [0.36, -0.02],
                [0.26, -0.04],
                [0.2, -0.13],
                [0.1, -0.1],
                [0.0, -0.12],
            ]
        )
        * span
    )
    web = wing([0, 0, 0], [(float(a), float(b)) for a, b in bat], float(rng.uniform(15, 50)), 0.0, 0.02)
    place = Frame(np.array([-0.20, 0.44, 0.0]), pitch(62))
    return [*parts, *carried([fuse(*web, blend=0.02)], place)]
