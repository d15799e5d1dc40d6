"""What stands in a garden: a snowman, a house."""

import numpy as np

from normalgan.animals.chain import pitch
from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, ball, block, both, fuse, ring, roll, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def snowman(pose: str, rng: Rng) -> list[Part]:
    """Return a snowman: two or three balls, a carrot, sticks, a hat on some."""
    f = factors(rng, 0.14, "low", "middle", "head", "nose")
    sizes = [0.33 * f["low"], 0.24 * f["middle"], 0.17 * f["head"]]
    if rng.uniform() < 0.3:
        sizes.pop(1)
    parts, y = [], 0.0
    for size in sizes:
        y += 0.80 * size
        parts.append(fuse(ball([0, y, 0], [size, 0.95 * size, size]), blend=0.02))
        middle, y = y, y + 0.80 * size
    head = sizes[-1]
    belly = middle - 0.8 * head - 0.72 * sizes[-2]
    nose = tube([[0.8 * head, middle, 0], [head + 0.20 * f["nose"], middle - 0.02, 0]], [0.05, 0.014])
    buttons = [ball([sizes[-2] * np.cos(a), belly + sizes[-2] * np.sin(a), 0], 0.034) for a in (0.0, 0.4)]
    up = float(rng.uniform(0.0, 0.35))
    arm = [
        [0, belly + 0.05, 0.5 * sizes[-2]],
        [0.03, belly + 0.12, sizes[-2] + 0.14],
        [0.05, belly + 0.1 + up, sizes[-2] + 0.32],
    ]
    twig = [arm[1], [0.05, belly + 0.24 + 0.3 * up, sizes[-2] + 0.24]]
    eyes = both(ball([0.84 * head, middle + 0.35 * head, 0.36 * head], 0.028))
    parts += [fuse(nose, blend=0.01), fuse(*buttons, *eyes), fuse(*both(tube(arm, 0.022), tube(twig, 0.018)))]
    if rng.uniform() < 0.7:
        brim = middle + 0.75 * head
        parts.append(fuse(ball([0, brim, 0], [1.25 * head, 0.03, 1.25 * head])))
        crown = tube(
            [[0, brim, 0], [0, brim + float(rng.uniform(0.14, 0.28)), 0]],
            [0.72 * head, 0.75 * head],
            flat=True,
        )
        parts.append(fuse(crown, blend=0.01))
    if rng.uniform() < 0.5:
        parts.append(fuse(ring([0, middle - 0.78 * head, 0], 0.72 * head, 0.05, roll(5)), blend=0.02))
    return parts


def house(pose: str, rng: Rng) -> list[Part]:
    """Return a small house: gabled roof, door, windows, chimney."""
    f = factors(rng, 0.18, "long", "wide", "high")
    deep, wide, high = 0.30 * f["wide"], 0.36 * f["long"], 0.26 * f["high"]
    steep = float(rng.uniform(32, 52))
    slant = deep / np.cos(np.deg2rad(steep)) + 0.09
    ridge = 2 * high + deep * np.tan(np.deg2rad(steep))
    walls = [block([0, high, 0], [deep, high, wide], 0.015)]
    gable = [
        tube(
            [[0, y, -wide + 0.04], [0, y, wide - 0.04]],
            0.03,
            max(0.02, 0.9 * (ridge - y) / np.tan(np.deg2rad(steep))),
            (1, 0, 0),
        )
        for y in np.linspace(2 * high - 0.02, ridge - 0.05, 14)
    ]
    roof = []
    for sign in (1, -1):
        down = np.array([sign * np.cos(np.deg2rad(steep)), -np.sin(np.deg2rad(steep)), 0])
        middle = np.array([0, ridge + 0.02, 0]) + down * slant / 2
        roof.append(block(middle, [slant / 2 + 0.02, 0.035, wide + 0.07], 0.02, pitch(-sign * steep)))
    door = block([deep, 0.55 * high, float(rng.uniform(-0.4, 0.4)) * wide], [0.05, 0.55 * high, 0.075], 0.015)
    panes: list[Shape] = [
        block([deep, 1.3 * high, s * 0.62 * wide], [0.04, 0.2 * high, 0.065], 0.01) for s in (1, -1)
    ]
    panes += both(block([0.0, 1.15 * high, wide], [0.09, 0.28 * high, 0.04], 0.01))
    stack = [-0.4 * deep, ridge - 0.3 * deep, float(rng.choice((-1, 1))) * 0.55 * wide]
    chimney = block(stack, [0.055, 0.55 * deep + 0.08, 0.055], 0.012)
    return [fuse(*walls, *gable), fuse(*roof), fuse(door, *panes, carve=True), fuse(chimney)]
