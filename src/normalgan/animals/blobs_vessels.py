"""Vessels, turned on a wheel: vase, mug, teapot."""

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, ball, block, both, fuse, ring, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors

SHAPES = ("belly", "bottle", "flute", "goblet", "bowl")


def turned(heights: list[float], radii: list[float], wall: float) -> list[Part]:
    """Return an open vessel on a flat foot.

    Args:
        heights: stations from the foot up, the last one the rim.
        radii: of its outside at these.
        wall: thickness.
    """
    rows = [[0.0, y, 0.0] for y in reversed(heights)]
    outer = tube(rows, radii[::-1])
    top, rim = heights[-1], radii[-1]
    thin = [y for y, r in zip(heights, radii, strict=True) if y > wall and r <= 2.4 * wall and y < 0.6 * top]
    floor = max([wall, *thin])  # a stem is not hollow
    bulb = 0.5 * max(float(np.interp(floor, heights, radii)), 2 * wall)
    inside = [(y, r - wall) for y, r in zip(heights, radii, strict=True) if y > floor + 1.5 * bulb]
    hollow = [(floor + bulb, bulb), *inside, (top + 0.3, rim - wall)]
    lid = block([0, top + 1.0, 0], [2.0, 1.0, 2.0], 0.01)
    return [
        fuse(outer),
        fuse(tube([[0, y, 0] for y, _ in hollow], [r for _, r in hollow]), lid, carve=True, blend=0.01),
        level(heights[0]),
    ]


def level(height: float) -> Part:
    """Return what takes away all below a height: a flat foot."""
    return fuse(block([0, height - 1.0, 0], [2.0, 1.0, 2.0], 0.01), carve=True)


def vase(pose: str, rng: Rng) -> list[Part]:
    """Return a vase, bottle, bowl or goblet, with two handles on some."""
    f = factors(rng, 0.2, "foot", "belly", "neck", "lip", "tall")
    kind = str(rng.choice(SHAPES))
    if kind == "bowl":
        return _bowl(0.5 * f["belly"], 0.42 * f["tall"], 0.22 * f["foot"])
    shapes = {
        "belly": ([0.0, 0.08, 0.4, 0.75, 0.9, 1.0], [0.16, 0.18, 0.34, 0.20, 0.14, 0.19]),
        "bottle": ([0.0, 0.08, 0.35, 0.55, 0.75, 1.0], [0.22, 0.25, 0.27, 0.18, 0.09, 0.10]),
        "flute": ([0.0, 0.1, 0.35, 0.65, 0.85, 1.0], [0.15, 0.13, 0.13, 0.19, 0.26, 0.33]),
        "goblet": ([0.0, 0.06, 0.3, 0.5, 0.75, 1.0], [0.24, 0.10, 0.055, 0.19, 0.27, 0.26]),
    }
    heights, radii = shapes[kind]
    scale = [f["foot"], f["foot"], f["belly"], f["belly"], f["neck"], f["lip"]]
    heights = [y * f["tall"] for y in heights]
    radii = [r * s for r, s in zip(radii, scale, strict=True)]
    parts = turned(heights, radii, 0.05)
    if kind in {"belly", "bottle"} and rng.uniform() < 0.5:
        low, high = heights[2] + 0.1, heights[4]
        out = radii[2] + float(rng.uniform(0.0, 0.12))
        loop = [
            [0, low, 0.85 * radii[2]],
            [0, (low + high) / 2 + 0.1, out + 0.02],
            [0, high + 0.03, 0.8 * out],
            [0, high, radii[4] - 0.01],
        ]
        parts.append(fuse(*both(tube(loop, 0.032)), blend=0.015))
    if rng.uniform() < 0.4:
        at = heights[3]
        parts.append(fuse(ring([0, at, 0], radii[3] * 1.0, 0.025), blend=0.01))
    return parts


def _bowl(wide: float, deep: float, foot: float) -> list[Part]:
    wall = 0.045
    lid = block([0, deep + 1.0, 0], [2.0, 1.0, 2.0], 0.01)
    return [
        fuse(ball([0, deep, 0], [wide, deep, wide])),
        fuse(tube([[0, 0.08, 0], [0, -0.02, 0]], [0.8 * foot, foot]), blend=0.04),
        level(-0.03),
        fuse(
            ball([0, deep + wall, 0], [wide - wall, deep - 0.5 * wall, wide - wall]),
            lid,
            carve=True,
            blend=0.01,
        ),
    ]


def mug(pose: str, rng: Rng) -> list[Part]:
    """Return a mug, its handle at the back."""
    f = factors(rng, 0.2, "tall", "wide", "taper", "handle")
    tall, wide = 0.75 * f["tall"], 0.30 * f["wide"]
    rim = wide * (1 + 0.6 * (f["taper"] - 1))
    parts = turned([0.0, 0.06, 0.35 * tall, 0.7 * tall, tall], [0.94 * wide, wide, wide, rim, rim], 0.05)
    out = 0.26 * f["handle"]
    loop = [
        [-wide + 0.02, 0.78 * tall, 0],
        [-wide - 0.8 * out, 0.80 * tall, 0],
        [-wide - out, 0.5 * tall, 0],
        [-wide - 0.6 * out, 0.2 * tall, 0],
        [-wide + 0.02, 0.2 * tall, 0],
    ]
    parts.append(fuse(tube(loop, 0.042, 0.06), blend=0.025))
    if rng.uniform() < 0.4:
        bands: list[Shape] = [ring([0, y * tall, 0], wide, 0.02) for y in (0.15, 0.85)]
        parts.append(fuse(*bands, blend=0.01))
    return parts


def teapot(pose: str, rng: Rng) -> list[Part]:
    """Return a teapot, its spout ahead."""
    f = factors(rng, 0.18, "tall", "wide", "spout", "knob", "handle")
    tall, wide = 0.34 * f["tall"], 0.42 * f["wide"]
    high = 0.06 + 1.55 * tall
    spout = [
        [0.75 * wide, 0.55 * tall, 0],
        [1.25 * wide, 0.8 * tall, 0],
        [1.45 * wide, 1.35 * tall, 0],
        [1.45 * wide + 0.16 * f["spout"], 1.75 * tall, 0],
    ]
    out = 0.30 * f["handle"]
    handle = [
        [-0.85 * wide, 1.45 * tall, 0],
        [-wide - 0.7 * out, 1.55 * tall, 0],
        [-wide - out, 1.05 * tall, 0],
        [-wide - 0.5 * out, 0.6 * tall, 0],
        [-0.86 * wide, 0.55 * tall, 0],
    ]
    if rng.uniform() < 0.3:  # over the top
        handle = [
            [0.55 * wide, 1.55 * tall, 0],
            [0.5 * wide, 2.3 * tall, 0],
            [0, 2.3 * tall + out, 0],
            [-0.5 * wide, 2.3 * tall, 0],
            [-0.55 * wide, 1.55 * tall, 0],
        ]
    mouth = np.array(spout[-1])
    aim = (mouth - spout[-2]) / np.linalg.norm(mouth - spout[-2])
    return [
        fuse(ball([0, 0.04 + tall, 0], [wide, tall, wide])),
        fuse(tube([[0, 0.10, 0], [0, 0.0, 0]], [0.5 * wide, 0.62 * wide], flat=True), blend=0.03),
        fuse(tube(spout, [0.145, 0.10, 0.075, 0.066], flat=True), blend=0.05),
        fuse(tube([mouth - 0.05 * aim, mouth + 0.1 * aim], 0.032), carve=True),
        fuse(tube(handle, 0.038, 0.05), blend=0.03),
        fuse(ring([0, high + 0.05 * tall, 0], 0.52 * wide, 0.03), blend=0.02),
        fuse(ball([0, high + 0.05 * tall, 0], [0.5 * wide, 0.26 * tall, 0.5 * wide]), blend=0.01),
        fuse(
            ball([0, high + 0.42 * tall, 0], 0.065 * f["knob"]),
            tube([[0, high, 0], [0, high + 0.4 * tall, 0]], 0.035),
            blend=0.02,
        ),
        level(-0.03),
    ]
