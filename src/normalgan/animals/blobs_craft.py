"""Toys that swim and fly: boat, plane, rocket."""

import numpy as np

from normalgan.animals.chain import pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, block, both, fuse, ring, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def boat(pose: str, rng: Rng) -> list[Part]:
    """Return a boat with sails or a funnel."""
    f = factors(rng, 0.16, "long", "wide", "deep", "mast")
    long, wide, deep = 0.52 * f["long"], 0.20 * f["wide"], 0.22 * f["deep"]
    hull = ball([0, 0, 0], [long, deep, wide])
    bow = tube(
        [[0.45 * long, -0.4 * deep, 0], [1.05 * long, 0.06, 0]], [0.5 * deep, 0.06], [0.45 * wide, 0.03]
    )
    deck = block([0, 0.5, 0], [1.5, 0.5, 1.0], 0.01)
    parts = [
        fuse(hull),
        fuse(bow, blend=0.08),
        fuse(deck, carve=True),
        fuse(ball([0, 0.02, 0], [0.85 * long, 0.5 * deep, 0.8 * wide]), carve=True, blend=0.02),
    ]
    if rng.uniform() < 0.5:
        top = 0.95 * f["mast"]
        mast = tube([[0.05, -0.9 * deep, 0], [0.05, top, 0]], [0.035, 0.025])
        boom = tube([[0.05, 0.12, 0], [-0.85 * long, 0.12, 0.03]], 0.024)
        main = tube([[0.02, 0.15, 0], [0.03, 0.55 * top, 0.03], [0.04, 0.95 * top, 0]], 0.022, 0.0)
        rows = np.linspace(0.13, 0.95 * top, 6)
        span = 0.85 * long * (1 - (rows - 0.13) / (0.92 * top))
        mids = np.column_stack([0.05 - span / 2, rows, 0.02 * np.sin(3 * rows)])
        main = tube(mids, 0.02, span / 2 + 0.01, (1, 0, 0))
        jib_span = 0.85 * long * (1 - (rows - 0.1) / (0.95 * top))
        jib = tube(
            np.column_stack([0.08 + jib_span / 2, rows, 0 * rows]), 0.02, jib_span / 2 + 0.005, (1, 0, 0)
        )
        return [*parts, fuse(mast, boom), fuse(main, jib)]
    house = block([-0.1 * long, 0.06, 0], [0.4 * long, 0.22, 0.6 * wide], 0.04)
    bridge = block([0.05 * long, 0.28, 0], [0.2 * long, 0.12, 0.5 * wide], 0.03)
    stacks = [
        tube([[x * long, 0.1, 0], [(x - 0.05) * long, 0.5 * f["mast"], 0]], 0.055, flat=True)
        for x in (-0.15, -0.38)
    ]
    holes = [ball([x * long, 0.16, 0.6 * wide], [0.04, 0.04, 0.03]) for x in (-0.35, -0.1, 0.15)]
    keel = fuse(tube([[-0.3 * long, -0.75 * deep, 0], [-0.1 * long, 0.0, 0]], 0.05), blend=0.02)
    return [
        *parts,
        keel,
        fuse(house, blend=0.01),
        fuse(bridge),
        fuse(*stacks),
        fuse(*both(*holes), carve=True),
    ]


def plane(pose: str, rng: Rng) -> list[Part]:
    """Return a toy aeroplane with jets or a propeller."""
    f = factors(rng, 0.16, "long", "fat", "span", "tail")
    fat, span = 0.115 * f["fat"], 0.62 * f["span"]
    rear = -0.62 * f["long"]
    back, up = float(rng.uniform(0.0, 0.32)), float(rng.uniform(-0.02, 0.10))
    hull = tube(
        [[rear, 0.06, 0], [-0.3, 0.02, 0], [0.1, 0, 0], [0.38, 0, 0], [0.5, -0.01, 0]],
        np.array([0.3, 0.85, 1.0, 0.9, 0.55]) * fat,
    )
    wings = tube([[0.05, -0.02, 0.0], [0.05 - back, up, span]], [0.032, 0.02], [0.17, 0.085], (1, 0, 0))
    fins = tube(
        [[rear + 0.06, 0.06, 0], [rear - 0.02, 0.07, 0.26 * f["tail"]]], 0.02, [0.10, 0.055], (1, 0, 0)
    )
    rudder = tube([[rear + 0.07, 0.05, 0], [rear - 0.05, 0.30 * f["tail"], 0]], 0.02, [0.11, 0.06], (1, 0, 0))
    parts = [
        fuse(hull),
        fuse(*both(wings, fins), rudder, blend=0.03),
        fuse(ball([0.25, 0.75 * fat, 0], [0.14, 0.6 * fat, 0.6 * fat]), blend=0.015),
    ]
    if rng.uniform() < 0.5:
        tip = 0.5 + 0.5 * fat
        blades = tube([[tip, 0.30, 0.0], [tip, 0, 0], [tip, -0.30, 0.0]], 0.02, [0.045, 0.025, 0.045])
        return [*parts, fuse(tube([[0.45, 0, 0], [tip + 0.03, 0, 0]], 0.045), blades, blend=0.01)]
    pods = [
        tube([[0.10 - 0.5 * back * k, -0.075, k * span], [-0.08 - 0.5 * back * k, -0.075, k * span]], 0.055)
        for k in (0.4, 0.68)[: int(rng.integers(1, 3))]
    ]
    return [*parts, fuse(*both(*pods), blend=0.02)]


def rocket(pose: str, rng: Rng) -> list[Part]:
    """Return a rocket on its fins."""
    f = factors(rng, 0.18, "tall", "fat", "fins")
    tall, fat = 1.0 * f["tall"], 0.16 * f["fat"]
    hull = tube(
        [[0, tall, 0], [0, 0.72 * tall, 0], [0, 0.4 * tall, 0], [0, 0.1, 0]],
        np.array([0.12, 0.85, 1.1, 0.75]) * fat,
        flat=True,
    )
    count = int(rng.integers(3, 6))
    fins = []
    for i in range(count):
        turn = yaw(360 / count * i)
        rows = np.array([[0.6 * fat, 0.40, 0], [1.5 * fat, 0.2, 0], [1.9 * fat * f["fins"], -0.06, 0]])
        fins.append(tube(rows @ turn.T, 0.022, [0.16, 0.12, 0.07], turn @ [0.5, 1.0, 0]))
    parts = [
        fuse(hull),
        fuse(*fins, blend=0.02),
        fuse(tube([[0, 0.15, 0], [0, 0.02, 0]], [0.5 * fat, 0.72 * fat], flat=True), blend=0.01),
    ]
    eye = [0.95 * fat, 0.66 * tall, 0]
    parts += [fuse(ball(eye, 0.4 * fat), carve=True), fuse(ring(eye, 0.42 * fat, 0.025, pitch(-90)))]
    return [*parts, fuse(ring([0, 0.72 * tall, 0], 0.86 * fat, 0.014), blend=0.01)]
