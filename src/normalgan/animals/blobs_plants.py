"""Plants in clumps and columns: tree, fir, cactus."""

import numpy as np

from normalgan.animals.blobs_vessels import level
from normalgan.animals.chain import yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, by, fuse, ring, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def tree(pose: str, rng: Rng) -> list[Part]:
    """Return a tree with a crown of round clumps."""
    f = factors(rng, 0.2, "tall", "trunk", "crown")
    tall, thick, wide = 0.50 * f["tall"], 0.075 * f["trunk"], 0.36 * f["crown"]
    lean = rng.uniform(-0.08, 0.08, 3) * [1, 0, 1]
    top = np.array([0, tall, 0]) + lean
    trunk = tube(
        [np.zeros(3), np.array([0, 0.12, 0]), top * 0.7, by(top, 0, 0.15, 0)],
        thick * np.array([1.7, 1.1, 0.9, 0.7]),
    )
    parts = [fuse(trunk)]
    roots = []
    for i in range(int(rng.integers(3, 6))):
        turn = yaw(float(rng.uniform(-15, 15)) + 72 * i)
        roots.append(
            tube(
                [np.array([0, 0.10, 0]), turn @ [1.6 * thick, 0.02, 0], turn @ [3.2 * thick, -0.02, 0]],
                thick * np.array([0.7, 0.5, 0.25]),
            )
        )
    parts.append(fuse(*roots, blend=0.03))
    crown = [ball(by(top, 0, 0.75 * wide, 0), [wide, 0.95 * wide, wide])]
    boughs = []
    for i in range(int(rng.integers(4, 9))):
        a, e = 2 * np.pi * (i * 0.618 + rng.uniform(-0.06, 0.06)), rng.uniform(-0.25, 1.1)
        ray = np.array([np.cos(a) * np.cos(e), np.sin(e), np.sin(a) * np.cos(e)])
        at = by(top, 0, 0.75 * wide, 0) + 0.75 * wide * ray
        crown.append(ball(at, wide * float(rng.uniform(0.45, 0.68))))
        boughs.append(tube([top * 0.75, at], 0.4 * thick))
    leaves = (0.012, 0.13) if rng.uniform() < 0.6 else None
    parts.append(fuse(*boughs, blend=0.03))
    parts += [fuse(clump, blend=0.05, ripple=leaves) for clump in crown]
    return parts


def fir(pose: str, rng: Rng) -> list[Part]:
    """Return a fir: cones on a trunk, one over the other."""
    f = factors(rng, 0.2, "wide", "trunk", "gap")
    count = int(rng.integers(3, 6))
    wide = 0.36 * f["wide"]
    parts = []
    step = 0.75 / count
    # From the top down, each tier cut off level before the next one is put under it.
    for i in reversed(range(count)):
        low, big = 0.22 + i * step, wide * (1 - 0.75 * i / count)
        tip = min(low + 2.1 * step * f["gap"], 1.12)
        skirt = tube([[0, tip, 0], [0, low - 0.5 * big, 0]], [0.02, 1.25 * big])
        parts += [fuse(skirt, blend=0.015), level(low)]
    parts.append(fuse(tube([[0, 0.9, 0], [0, 0.0, 0]], 0.07 * f["trunk"], flat=True)))
    if rng.uniform() < 0.4:
        pot = tube([[0, 0.06, 0], [0, -0.16, 0]], [0.17, 0.12], flat=True)
        parts.append(fuse(pot, blend=0.01))
    return parts


def cactus(pose: str, rng: Rng) -> list[Part]:
    """Return a cactus with arms, ribbed, in a pot on some."""
    f = factors(rng, 0.2, "tall", "thick", "arms")
    tall, thick = 0.85 * f["tall"], 0.13 * f["thick"]
    column = tube([[0, 0.0, 0], [0, 0.5 * tall, 0], [0, tall, 0]], [0.9 * thick, 1.05 * thick, 0.85 * thick])
    parts = [fuse(column)]
    arms = []
    for i in range(int(rng.integers(1, 4))):
        turn = yaw(90 + 180 * i + float(rng.uniform(-25, 25)))
        low, out = tall * float(rng.uniform(0.25, 0.6)), thick + 0.18 * f["arms"]
        up = low + 0.30 * f["arms"] * float(rng.uniform(0.5, 1.2))
        rows = [[0, low, 0], [0.75 * out, low, 0], [out + 0.03, low + 0.09, 0], [out + 0.03, up, 0]]
        arms.append(tube(np.array(rows) @ turn.T, 0.62 * thick))
    parts.append(fuse(*arms, blend=0.03))
    ribs = []
    for i in range(9):
        a = 2 * np.pi * i / 9
        ray = np.array([np.cos(a), 0, np.sin(a)])
        line = [by(1.04 * thick * ray, 0, y * tall, 0) for y in (0.0, 0.5, 0.95)]
        ribs.append(tube(line, 0.014))
    parts.insert(1, fuse(*ribs, blend=0.02, carve=True))
    if rng.uniform() < 0.5:
        bowl = tube([[0, 0.08, 0], [0, -0.2, 0]], [2.0 * thick, 1.4 * thick], flat=True)
        parts += [fuse(bowl, blend=0.01), fuse(ring([0, 0.12, 0], 1.95 * thick, 0.04), blend=0.01)]
    return parts
