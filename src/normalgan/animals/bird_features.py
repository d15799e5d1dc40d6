"""What grows on some birds: combs, plumes, veils; and the skulls that many share."""

import numpy as np

from normalgan.animals.chain import Frame
from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, both, fuse, tube
from normalgan.animals.outline import rounded
from normalgan.animals.plan import Rng
from normalgan.animals.plate import Plate

ROUND = (
    (-0.40, 0.14, -0.14, 0.14), (-0.24, 0.36, -0.36, 0.35), (0.0, 0.46, -0.44, 0.42),
    (0.24, 0.38, -0.36, 0.33), (0.38, 0.16, -0.20, 0.17),
)  # fmt: skip
LONG = (
    (-0.40, 0.14, -0.16, 0.14), (-0.24, 0.32, -0.32, 0.29), (0.0, 0.36, -0.36, 0.33),
    (0.26, 0.27, -0.30, 0.26), (0.46, 0.10, -0.20, 0.17),
)  # fmt: skip


def comb(rng: Rng, _: float) -> list[Part]:
    """Return a cock's comb and wattles; a hen's are smaller."""
    size = float(rng.uniform(0.6, 1.25))
    edge = [(-0.42, 0.28), (-0.46, 0.60), (-0.28, 0.52), (-0.20, 0.80), (-0.06, 0.56), (0.06, 0.84),
            (0.18, 0.54), (0.32, 0.68), (0.40, 0.40), (0.30, 0.20)]  # fmt: skip
    outline = rounded([(x, 0.3 + (y - 0.3) * size) for x, y in edge], 1)
    lobes = both(tube([(0.34, -0.22, 0.10), (0.36, -0.22 - 0.36 * size, 0.14)], [0.08, 0.13], 0.05))
    return [
        fuse(Plate(outline, Frame(np.zeros(3), np.eye(3)), rim=0.055), blend=0.03),
        fuse(*lobes, blend=0.03),
    ]


def sickles(rng: Rng, factor: float) -> list[Part]:
    """Return the drooping tail feathers of a cock; hens have none."""
    if rng.uniform() < 0.5:
        return []
    arcs: list[Shape] = []
    for i in range(4):
        z, reach = 0.02 + 0.03 * i, factor * (1.25 - 0.14 * i)
        arc = np.array(
            [
                (0.1, 0.1, z),
                (-0.12, 0.42, z),
                (-0.40, 0.60, 1.4 * z),
                (-0.66, 0.52, 1.8 * z),
                (-0.80, 0.26, 2 * z),
            ]
        )
        arcs += both(tube(arc * [reach, reach, 1], [0.05, 0.065, 0.06, 0.05, 0.02], 0.018))
    return [fuse(*arcs, blend=0.01)]


def tufts(rng: Rng, _: float) -> list[Part]:
    """Return an owl's veil of feathers round the eyes, and the ears of some."""
    parts = [fuse(*both(tube([(0.30, 0.06, 0.17), (0.335, 0.06, 0.19)], 0.24, 0.24)), blend=0.03),
             fuse(*both(tube([(0.40, 0.07, 0.19), (0.70, 0.075, 0.30)], 0.18)), blend=0.05, carve=True),
             fuse(*both(tube([(0.30, 0.08, 0.18), (0.31, 0.08, 0.185)], 0.155)))]  # fmt: skip
    if rng.uniform() < 0.6:
        ears = tube(
            [(0.16, 0.34, 0.22), (0.10, 0.52, 0.33), (0.02, 0.72, 0.42)],
            [0.12, 0.09, 0.02],
            [0.07, 0.05, 0.02],
        )
        parts.append(fuse(*both(ears), blend=0.06))
    return parts


def plume(_: Rng, factor: float) -> list[Part]:
    """Return the plumes at the back of a heron's head."""
    plume = tube([(-0.3, 0.18, 0), (-0.75, 0.14, 0), (-1.25 * factor, -0.12, 0)], [0.07, 0.06, 0.02])
    return [fuse(plume, blend=0.04)]


def brow(_: Rng, __: float) -> list[Part]:
    """Return the ridge over an eagle's eye."""
    return [
        fuse(
            *both(tube([(-0.02, 0.21, 0.34), (0.20, 0.22, 0.31), (0.36, 0.15, 0.21)], [0.05, 0.06, 0.04])),
            blend=0.06,
        )
    ]
