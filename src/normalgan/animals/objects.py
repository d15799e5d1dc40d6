"""Objects, one function each: vessels, cars, boats and planes, garden objects, plants, shapeless blobs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from normalgan.animals.frames import pitch, ray, roll, unit, yaw
from normalgan.animals.parts import Part, Ripple, ball, block, both, by, fuse, pair, ring, tube
from normalgan.animals.plan import BodyPlan, FunctionPlan, Rng, around
from normalgan.animals.shapes import Shape
from normalgan.arrays import Doubles


def turned(heights: Sequence[float], radii: Sequence[float], wall: float) -> list[Part]:
    """Return an open vessel on a flat foot.

    Args:
        heights: heights of stations from the foot to the rim.
        radii: outer radii at these heights.
        wall: thickness of the wall.
    """
    rows = list(zip(heights, radii, strict=True))
    top, rim = rows[-1]
    stems = [y for y, r in rows if y > wall and r <= 2.4 * wall and y < 0.6 * top]
    floor = max([wall, *stems])  # stems are not hollow
    bulb = 0.5 * max(float(np.interp(floor, heights, radii)), 2 * wall)
    inside = [(y, r - wall) for y, r in rows if y > floor + 1.5 * bulb]
    hollow = [(floor + bulb, bulb), *inside, (top + 0.3, rim - wall)]
    return [
        fuse(tube([(0, y) for y, _ in reversed(rows)], [r for _, r in reversed(rows)])),
        fuse(tube([(0, y) for y, _ in hollow], [r for _, r in hollow]), _above(top), carve=True, blend=0.01),
        _level(heights[0]),
    ]


def _above(height: float) -> Shape:
    return block((0, height + 1.0), [2.0, 1.0, 2.0], 0.01)


def _level(height: float) -> Part:
    """Return a part that cuts away everything below a height, to make a flat foot."""
    return fuse(block((0, height - 1.0), [2.0, 1.0, 2.0], 0.01), carve=True)


_VESSELS: Mapping[str, tuple[Sequence[float], Sequence[float]]] = {
    "belly": ([0.0, 0.08, 0.4, 0.75, 0.9, 1.0], [0.16, 0.18, 0.34, 0.20, 0.14, 0.19]),
    "bottle": ([0.0, 0.08, 0.35, 0.55, 0.75, 1.0], [0.22, 0.25, 0.27, 0.18, 0.09, 0.10]),
    "flute": ([0.0, 0.1, 0.35, 0.65, 0.85, 1.0], [0.15, 0.13, 0.13, 0.19, 0.26, 0.33]),
    "goblet": ([0.0, 0.06, 0.3, 0.5, 0.75, 1.0], [0.24, 0.10, 0.055, 0.19, 0.27, 0.26]),
}
"""Heights and radii of vessels by kind."""


def _vase(pose: str, rng: Rng) -> list[Part]:
    """Return a vase, bottle, bowl or goblet, sometimes with two handles."""
    foot, belly, neck, lip, tall = around(rng, 0.2, 1.0, 1.0, 1.0, 1.0, 1.0)
    kind = str(rng.choice([*_VESSELS, "bowl"]))
    if kind == "bowl":
        return _bowl(0.5 * belly, 0.42 * tall, 0.22 * foot)
    heights = [y * tall for y in _VESSELS[kind][0]]
    radii = [r * f for r, f in zip(_VESSELS[kind][1], (foot, foot, belly, belly, neck, lip), strict=True)]
    parts = turned(heights, radii, 0.05)
    if kind in {"belly", "bottle"} and rng.uniform() < 0.5:
        low, high = heights[2] + 0.1, heights[4]
        out = radii[2] + rng.uniform(0.0, 0.12)
        up = [low, (low + high) / 2 + 0.1, high + 0.03, high]
        aside = [0.85 * radii[2], out + 0.02, 0.8 * out, radii[4] - 0.01]
        parts.append(pair(tube(np.column_stack([np.zeros(4), up, aside]), 0.032), blend=0.015))
    if rng.uniform() < 0.4:
        parts.append(fuse(ring((0, heights[3]), radii[3], 0.025), blend=0.01))
    return parts


def _bowl(wide: float, deep: float, foot: float) -> list[Part]:
    wall = 0.045
    hollow = ball((0, deep + wall), [wide - wall, deep - 0.5 * wall, wide - wall])
    return [
        fuse(ball((0, deep), [wide, deep, wide])),
        fuse(tube([(0, 0.08), (0, -0.02)], [0.8 * foot, foot]), blend=0.04),
        _level(-0.03),
        fuse(hollow, _above(deep), carve=True, blend=0.01),
    ]


def _mug(pose: str, rng: Rng) -> list[Part]:
    """Return a mug with its handle at the back."""
    tall, wide, taper, out = around(rng, 0.2, 0.75, 0.30, 1.0, 0.26)
    rim = wide * (1 + 0.6 * (taper - 1))
    parts = turned([0.0, 0.06, 0.35 * tall, 0.7 * tall, tall], [0.94 * wide, wide, wide, rim, rim], 0.05)
    behind = np.array([-0.02, 0.8 * out, out, 0.6 * out, -0.02])
    loop = np.column_stack([-wide - behind, np.array([0.78, 0.80, 0.5, 0.2, 0.2]) * tall])
    parts.append(fuse(tube(loop, 0.042, 0.06), blend=0.025))
    if rng.uniform() < 0.4:
        parts.append(fuse(*(ring((0, y * tall), wide, 0.02) for y in (0.15, 0.85)), blend=0.01))
    return parts


def _teapot(pose: str, rng: Rng) -> list[Part]:
    """Return a teapot with its spout in front."""
    tall, wide, far, knob, out = around(rng, 0.18, 0.34, 0.42, 0.16, 0.065, 0.30)
    high = 0.06 + 1.55 * tall
    size = np.array([wide, tall])
    spout = np.array([(0.75, 0.55), (1.25, 0.8), (1.45, 1.35), (1.45, 1.75)]) * size
    spout[-1, 0] += far
    if rng.uniform() < 0.3:  # over the top
        handle = np.array([(0.55, 1.55), (0.5, 2.3), (0, 2.3), (-0.5, 2.3), (-0.55, 1.55)]) * size
        handle[2, 1] += out
    else:
        handle = np.array([(-0.85, 1.45), (-1, 1.55), (-1, 1.05), (-1, 0.6), (-0.86, 0.55)]) * size
        handle[1:4, 0] -= np.array([0.7, 1.0, 0.5]) * out
    mouth = spout[-1]
    aim = unit(mouth - spout[-2])
    grip = ball((0, high + 0.42 * tall), knob)
    return [
        fuse(ball((0, 0.04 + tall), [wide, tall, wide])),
        fuse(tube([(0, 0.10), (0, 0.0)], [0.5 * wide, 0.62 * wide], flat=True), blend=0.03),
        fuse(tube(spout, [0.145, 0.10, 0.075, 0.066], flat=True), blend=0.05),
        fuse(tube([mouth - 0.05 * aim, mouth + 0.1 * aim], 0.032), carve=True),
        fuse(tube(handle, 0.038, 0.05), blend=0.03),
        fuse(ring((0, high + 0.05 * tall), 0.52 * wide, 0.03), blend=0.02),
        fuse(ball((0, high + 0.05 * tall), [0.5 * wide, 0.26 * tall, 0.5 * wide]), blend=0.01),
        fuse(grip, tube([(0, high), (0, high + 0.4 * tall)], 0.035), blend=0.02),
        _level(-0.03),
    ]


def _car(pose: str, rng: Rng) -> list[Part]:
    """Return a toy car: sedan, van, truck or racer."""
    long, wide, tall, wheel = around(rng, 0.14, 0.52, 0.23, 1.0, 0.12)
    kind = str(rng.choice(("sedan", "beetle", "van", "truck", "racer")))
    low, high = 0.10 * tall, 0.13 * tall
    floor = wheel + low
    deck = floor + low
    edge = rng.uniform(0.04, 0.09)
    parts = [fuse(block((0, floor), [long, low, wide], edge))]
    cabin, panes = 0.0, 0.0  # positions of the side windows, and half of their length
    if kind == "beetle":
        dome = ball((-0.05, floor + 0.4 * low), [0.75 * long, 2.2 * high, 0.92 * wide])
        parts.append(fuse(dome, blend=0.05))
        cabin, panes = -0.05, 0.28 * long
    elif kind == "van":
        parts.append(fuse(block((-0.08, deck + 0.7 * high), [0.82 * long, 1.3 * high, 0.97 * wide], edge)))
        panes = 0.45 * long
    elif kind == "truck":
        cab = block((0.55 * long, deck + 0.6 * high), [0.33 * long, 1.2 * high, 0.95 * wide], edge)
        bed = block((-0.40 * long, deck + 0.3 * high), [0.56 * long, 0.6 * high, 0.98 * wide], 0.03)
        load = block((-0.40 * long, deck + 0.8 * high), [0.48 * long, 0.8 * high, 0.8 * wide], 0.02)
        parts += [fuse(cab), fuse(bed), fuse(load, carve=True)]
        cabin, panes = 0.55 * long, 0.15 * long
    elif kind == "racer":
        bonnet = [(0.3 * long, floor), (1.35 * long, floor - 0.3 * low)]
        nose = tube(bonnet, [low, 0.5 * low], [0.9 * wide, 0.35 * wide])
        vane = block((-0.95 * long, floor + 2.6 * low), [0.09, 0.022, 1.1 * wide], 0.02)
        post = [[-0.9 * long, floor, 0.6 * wide], [-0.95 * long, floor + 2.6 * low, 0.6 * wide]]
        parts += [
            fuse(nose, blend=0.05),
            fuse(ball((-0.1, deck), [0.12, 0.13, 0.1]), blend=0.03),
            fuse(vane, *both(tube(post, 0.025))),
        ]
    else:
        roof = np.array([(0.42, 0.0), (0.12, 1.0), (-0.42, 1.0), (-0.68, 0.0)]) * [long, high] + [0.0, deck]
        body = block((-0.13 * long, deck + 0.5 * high), [0.45 * long, 0.8 * high, 0.86 * wide], 0.04)
        parts.append(fuse(tube(roof, 0.55 * high, 0.88 * wide), body, blend=0.03))
        cabin, panes = -0.08, 0.26 * long
    if panes:
        pane = block([cabin, deck + 0.85 * high, wide], [panes, 0.45 * high, 0.06], 0.02)
        parts.append(pair(pane, carve=True, blend=0.01))
    axles = (0.62 * long, -0.62 * long)
    rods = [tube([[x, wheel, -wide], [x, wheel, wide]], 0.35 * wheel) for x in axles]
    tyres = both(*(ball([x, wheel, wide - 0.01], [wheel, wheel, 0.075]) for x in axles))
    arches = [ball([x, wheel, wide], [1.25 * wheel, 1.25 * wheel, 0.09]) for x in axles]
    hubs = [ball([x, wheel, wide + 0.07], [0.5 * wheel, 0.5 * wheel, 0.03]) for x in axles]
    bumper = [[long, floor - 0.6 * low, -0.9 * wide], [long + 0.02, floor - 0.6 * low, 0.9 * wide]]
    return [
        *parts,
        pair(*arches, carve=True),
        fuse(*tyres, *rods),
        pair(*hubs, carve=True, blend=0.01),
        pair(ball([long - 0.005, floor + 0.2 * low, 0.62 * wide], [0.03, 0.045, 0.045]), blend=0.01),
        fuse(tube(bumper, 0.035), blend=0.01),
    ]


def _boat(pose: str, rng: Rng) -> list[Part]:
    """Return a boat with sails or a funnel."""
    long, wide, deep, mast = around(rng, 0.16, 0.52, 0.20, 0.22, 1.0)
    ahead = [(0.45 * long, -0.4 * deep), (1.05 * long, 0.06)]
    parts = [
        fuse(ball((0, 0), [long, deep, wide])),
        fuse(tube(ahead, [0.5 * deep, 0.06], [0.45 * wide, 0.03]), blend=0.08),
        fuse(block((0, 0.5), [1.5, 0.5, 1.0], 0.01), carve=True),
        fuse(ball((0, 0.02), [0.85 * long, 0.5 * deep, 0.8 * wide]), carve=True, blend=0.02),
    ]
    if rng.uniform() < 0.5:
        top = 0.95 * mast
        pole = tube([(0.05, -0.9 * deep), (0.05, top)], [0.035, 0.025])
        boom = tube([[0.05, 0.12, 0], [-0.85 * long, 0.12, 0.03]], 0.024)
        rows = np.linspace(0.13, 0.95 * top, 6)
        span = 0.85 * long * (1 - (rows - 0.13) / (0.92 * top))
        leech = np.column_stack([0.05 - span / 2, rows, 0.02 * np.sin(3 * rows)])
        main = tube(leech, 0.02, span / 2 + 0.01, (1, 0, 0))
        span = 0.85 * long * (1 - (rows - 0.1) / (0.95 * top))
        jib = tube(np.column_stack([0.08 + span / 2, rows]), 0.02, span / 2 + 0.005, (1, 0, 0))
        return [*parts, fuse(pole, boom), fuse(main, jib)]
    stacks = [
        tube([(x * long, 0.1), ((x - 0.05) * long, 0.5 * mast)], 0.055, flat=True) for x in (-0.15, -0.38)
    ]
    holes = [ball([x * long, 0.16, 0.6 * wide], [0.04, 0.04, 0.03]) for x in (-0.35, -0.1, 0.15)]
    return [
        *parts,
        fuse(tube([(-0.3 * long, -0.75 * deep), (-0.1 * long, 0.0)], 0.05), blend=0.02),
        fuse(block((-0.1 * long, 0.06), [0.4 * long, 0.22, 0.6 * wide], 0.04), blend=0.01),
        fuse(block((0.05 * long, 0.28), [0.2 * long, 0.12, 0.5 * wide], 0.03)),
        fuse(*stacks),
        pair(*holes, carve=True),
    ]


def _plane(pose: str, rng: Rng) -> list[Part]:
    """Return a toy aeroplane with jets or a propeller."""
    long, fat, span, tail = around(rng, 0.16, 0.62, 0.115, 0.62, 1.0)
    rear = -long
    back, up = rng.uniform(0.0, 0.32), rng.uniform(-0.02, 0.10)
    axis = [(rear, 0.06), (-0.3, 0.02), (0.1, 0), (0.38, 0), (0.5, -0.01)]
    hull = tube(axis, np.array([0.3, 0.85, 1.0, 0.9, 0.55]) * fat)
    wings = tube([[0.05, -0.02, 0.0], [0.05 - back, up, span]], [0.032, 0.02], [0.17, 0.085], (1, 0, 0))
    fins = tube([[rear + 0.06, 0.06, 0], [rear - 0.02, 0.07, 0.26 * tail]], 0.02, [0.10, 0.055], (1, 0, 0))
    rudder = tube([(rear + 0.07, 0.05), (rear - 0.05, 0.30 * tail)], 0.02, [0.11, 0.06], (1, 0, 0))
    parts = [
        fuse(hull),
        fuse(*both(wings, fins), rudder, blend=0.03),
        fuse(ball((0.25, 0.75 * fat), [0.14, 0.6 * fat, 0.6 * fat]), blend=0.015),
    ]
    if rng.uniform() < 0.5:
        tip = 0.5 + 0.5 * fat
        blades = tube([(tip, 0.30), (tip, 0), (tip, -0.30)], 0.02, [0.045, 0.025, 0.045])
        return [*parts, fuse(tube([(0.45, 0), (tip + 0.03, 0)], 0.045), blades, blend=0.01)]
    pods = []
    for k in (0.4, 0.68)[: int(rng.integers(1, 3))]:
        pods.append(tube([[x - 0.5 * back * k, -0.075, k * span] for x in (0.10, -0.08)], 0.055))
    return [*parts, pair(*pods, blend=0.02)]


def _rocket(pose: str, rng: Rng) -> list[Part]:
    """Return a rocket on its fins."""
    tall, fat, broad = around(rng, 0.18, 1.0, 0.16, 1.0)
    axis = [(0, tall), (0, 0.72 * tall), (0, 0.4 * tall), (0, 0.1)]
    count = int(rng.integers(3, 6))
    fins = []
    for i in range(count):
        turn = yaw(360 / count * i)
        rows = np.array([[0.6 * fat, 0.40, 0], [1.5 * fat, 0.2, 0], [1.9 * fat * broad, -0.06, 0]])
        fins.append(tube(rows @ turn.T, 0.022, [0.16, 0.12, 0.07], turn @ [0.5, 1.0, 0]))
    eye = (0.95 * fat, 0.66 * tall)
    return [
        fuse(tube(axis, np.array([0.12, 0.85, 1.1, 0.75]) * fat, flat=True)),
        fuse(*fins, blend=0.02),
        fuse(tube([(0, 0.15), (0, 0.02)], [0.5 * fat, 0.72 * fat], flat=True), blend=0.01),
        fuse(ball(eye, 0.4 * fat), carve=True),
        fuse(ring(eye, 0.42 * fat, 0.025, pitch(-90))),
        fuse(ring((0, 0.72 * tall), 0.86 * fat, 0.014), blend=0.01),
    ]


def _snowman(pose: str, rng: Rng) -> list[Part]:
    """Return a snowman: two or three balls, a carrot, sticks, sometimes a hat."""
    *sizes, carrot = around(rng, 0.14, 0.33, 0.24, 0.17, 0.20)
    if rng.uniform() < 0.3:
        sizes.pop(1)
    parts, y = [], 0.0
    for size in sizes:
        y += 0.80 * size
        parts.append(fuse(ball((0, y), [size, 0.95 * size, size]), blend=0.02))
        middle, y = y, y + 0.80 * size
    trunk, head = sizes[-2:]
    belly = middle - 0.8 * head - 0.72 * trunk
    nose = tube([(0.8 * head, middle), (head + carrot, middle - 0.02)], [0.05, 0.014])
    buttons = [ball((trunk * np.cos(a), belly + trunk * np.sin(a)), 0.034) for a in (0.0, 0.4)]
    eyes = both(ball([0.84 * head, middle + 0.35 * head, 0.36 * head], 0.028))
    up = rng.uniform(0.0, 0.35)
    hand = [0.03, belly + 0.12, trunk + 0.14]
    arm = tube([[0, belly + 0.05, 0.5 * trunk], hand, [0.05, belly + 0.1 + up, trunk + 0.32]], 0.022)
    twig = tube([hand, [0.05, belly + 0.24 + 0.3 * up, trunk + 0.24]], 0.018)
    parts += [fuse(nose, blend=0.01), fuse(*buttons, *eyes), pair(arm, twig)]
    if rng.uniform() < 0.7:
        brim = middle + 0.75 * head
        parts.append(fuse(ball((0, brim), [1.25 * head, 0.03, 1.25 * head])))
        crown = [(0, brim), (0, brim + rng.uniform(0.14, 0.28))]
        parts.append(fuse(tube(crown, [0.72 * head, 0.75 * head], flat=True), blend=0.01))
    if rng.uniform() < 0.5:
        parts.append(fuse(ring((0, middle - 0.78 * head), 0.72 * head, 0.05, roll(5)), blend=0.02))
    return parts


def _house(pose: str, rng: Rng) -> list[Part]:
    """Return a small house: gabled roof, door, windows, chimney."""
    wide, deep, high = around(rng, 0.18, 0.36, 0.30, 0.26)
    steep = rng.uniform(32, 52)
    slope = np.deg2rad(steep)
    slant = deep / np.cos(slope) + 0.09
    ridge = 2 * high + deep * np.tan(slope)
    gable = []
    for y in np.linspace(2 * high - 0.02, ridge - 0.05, 14):
        half = max(0.02, 0.9 * (ridge - y) / np.tan(slope))
        gable.append(tube([[0, y, -wide + 0.04], [0, y, wide - 0.04]], 0.03, half, (1, 0, 0)))
    roof = []
    for sign in (1, -1):
        down = np.array([sign * np.cos(slope), -np.sin(slope), 0])
        middle = np.array([0, ridge + 0.02, 0]) + down * slant / 2
        roof.append(block(middle, [slant / 2 + 0.02, 0.035, wide + 0.07], 0.02, pitch(-sign * steep)))
    door = block([deep, 0.55 * high, rng.uniform(-0.4, 0.4) * wide], [0.05, 0.55 * high, 0.075], 0.015)
    panes = [
        *both(block([deep, 1.3 * high, 0.62 * wide], [0.04, 0.2 * high, 0.065], 0.01)),
        *both(block([0.0, 1.15 * high, wide], [0.09, 0.28 * high, 0.04], 0.01)),
    ]
    stack = [-0.4 * deep, ridge - 0.3 * deep, float(rng.choice((-1, 1))) * 0.55 * wide]
    return [
        fuse(block((0, high), [deep, high, wide], 0.015), *gable),
        fuse(*roof),
        fuse(door, *panes, carve=True),
        fuse(block(stack, [0.055, 0.55 * deep + 0.08, 0.055], 0.012)),
    ]


def _tree(pose: str, rng: Rng) -> list[Part]:
    """Return a tree with a crown of round clumps."""
    tall, thick, wide = around(rng, 0.2, 0.50, 0.075, 0.36)
    lean = rng.uniform(-0.08, 0.08, 3) * [1, 0, 1]
    top = np.array([0, tall, 0]) + lean
    trunk = [np.zeros(3), np.array([0, 0.12, 0]), top * 0.7, by(top, 0, 0.15, 0)]
    parts = [fuse(tube(trunk, thick * np.array([1.7, 1.1, 0.9, 0.7])))]
    roots = []
    for i in range(int(rng.integers(3, 6))):
        turn = yaw(rng.uniform(-15, 15) + 72 * i)
        root = [np.array([0, 0.10, 0]), turn @ [1.6 * thick, 0.02, 0], turn @ [3.2 * thick, -0.02, 0]]
        roots.append(tube(root, thick * np.array([0.7, 0.5, 0.25])))
    parts.append(fuse(*roots, blend=0.03))
    middle = by(top, 0, 0.75 * wide, 0)
    crown = [ball(middle, [wide, 0.95 * wide, wide])]
    boughs = []
    for i in range(int(rng.integers(4, 9))):
        a, e = 2 * np.pi * (i * 0.618 + rng.uniform(-0.06, 0.06)), rng.uniform(-0.25, 1.1)
        at = middle + 0.75 * wide * ray(a, e)
        crown.append(ball(at, wide * rng.uniform(0.45, 0.68)))
        boughs.append(tube([top * 0.75, at], 0.4 * thick))
    leaves = Ripple(0.012, 0.13) if rng.uniform() < 0.6 else None
    parts.append(fuse(*boughs, blend=0.03))
    return parts + [fuse(clump, blend=0.05, ripple=leaves) for clump in crown]


def _fir(pose: str, rng: Rng) -> list[Part]:
    """Return a fir: cones stacked on a trunk."""
    wide, trunk, gap = around(rng, 0.2, 0.36, 0.07, 1.0)
    count = int(rng.integers(3, 6))
    step = 0.75 / count
    parts = []
    # From the top down, each tier is cut off horizontally before the next one is added below.
    for i in reversed(range(count)):
        low, big = 0.22 + i * step, wide * (1 - 0.75 * i / count)
        tip = min(low + 2.1 * step * gap, 1.12)
        skirt = tube([(0, tip), (0, low - 0.5 * big)], [0.02, 1.25 * big])
        parts += [fuse(skirt, blend=0.015), _level(low)]
    parts.append(fuse(tube([(0, 0.9), (0, 0.0)], trunk, flat=True)))
    if rng.uniform() < 0.4:
        parts.append(fuse(tube([(0, 0.06), (0, -0.16)], [0.17, 0.12], flat=True), blend=0.01))  # a pot
    return parts


def _cactus(pose: str, rng: Rng) -> list[Part]:
    """Return a ribbed cactus with arms, sometimes in a pot."""
    tall, thick, long = around(rng, 0.2, 0.85, 0.13, 1.0)
    column = tube([(0, 0.0), (0, 0.5 * tall), (0, tall)], [0.9 * thick, 1.05 * thick, 0.85 * thick])
    arms = []
    for i in range(int(rng.integers(1, 4))):
        turn = yaw(90 + 180 * i + rng.uniform(-25, 25))
        low, out = tall * rng.uniform(0.25, 0.6), thick + 0.18 * long
        up = low + 0.30 * long * rng.uniform(0.5, 1.2)
        rows = [[0, low, 0], [0.75 * out, low, 0], [out + 0.03, low + 0.09, 0], [out + 0.03, up, 0]]
        arms.append(tube(np.array(rows) @ turn.T, 0.62 * thick))
    ribs = []
    for i in range(9):
        foot = 1.04 * thick * ray(2 * np.pi * i / 9, 0.0)
        ribs.append(tube([by(foot, 0, y * tall, 0) for y in (0.0, 0.5, 0.95)], 0.014))
    parts = [fuse(column), fuse(*ribs, blend=0.02, carve=True), fuse(*arms, blend=0.03)]
    if rng.uniform() < 0.5:
        pot = tube([(0, 0.08), (0, -0.2)], [2.0 * thick, 1.4 * thick], flat=True)
        parts += [fuse(pot, blend=0.01), fuse(ring((0, 0.12), 1.95 * thick, 0.04), blend=0.01)]
    return parts


def _mushroom(pose: str, rng: Rng) -> list[Part]:
    """Return a mushroom, sometimes with a small one next to it or a collar."""
    parts = _one_mushroom(rng, np.zeros(3), 1.0, blend=0.0)
    if rng.uniform() < 0.4:
        at = np.array([0.10, 0.0, float(rng.choice((-1, 1))) * 0.12])
        parts += _one_mushroom(rng, at, rng.uniform(0.45, 0.6), blend=0.03, lean=0.15)
    return parts


def _one_mushroom(rng: Rng, at: Doubles, size: float, blend: float, lean: float = 0.0) -> list[Part]:
    tall, stem, wide, high = (size * length for length in around(rng, 0.22, 0.62, 0.10, 0.38, 0.30))
    away = at * lean * 8 + rng.uniform(-0.05, 0.05, 3) * [1, 0, 1]
    top = by(at, 0, tall, 0) + away
    hollow = ball(by(top, 0, -0.62 * high, 0), [0.86 * wide, 0.62 * high, 0.86 * wide])
    stalk = [at, by(at, 0, 0.3 * tall, 0) + 0.3 * away, by(top, 0, 0.3 * high, 0)]
    parts = [
        fuse(ball(top, [wide, high, wide]), blend=blend),
        fuse(hollow, blend=0.04 * size, carve=True),
        fuse(tube(stalk, [1.7 * stem, stem, 0.9 * stem]), blend=0.02 * size),
    ]
    if rng.uniform() < 0.4:
        spots = []
        for _ in range(9):
            on_cap = ray(rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(25, 90)))
            spots.append(ball(top + on_cap * [wide, high, wide], 0.05 * size * rng.uniform(0.7, 1.3)))
        parts.append(fuse(*spots, blend=0.03 * size))
    return parts


_PIECES = ("ball", "ball", "rod", "rod", "cone", "block", "ring", "worm")
_INNER = 0.5  # fraction of a piece's radii within which others may be attached; dents are shallower


@dataclass(frozen=True, eq=False)
class _Piece:
    """A solid with points (n, 3) inside it where other parts can be attached."""

    shape: Shape
    roots: Doubles


def _blob(pose: str, rng: Rng) -> list[Part]:
    """Return a lopsided compound."""
    return _grown(rng, both_sides=False)


def _creature(pose: str, rng: Rng) -> list[Part]:
    """Return a mirror-symmetric compound."""
    return _grown(rng, both_sides=True)


def _grown(rng: Rng, both_sides: bool) -> list[Part]:
    core = _core(rng, both_sides)
    soft = rng.uniform(0.0, 0.22)
    ripple = Ripple(rng.uniform(0.006, 0.02), rng.uniform(0.12, 0.3)) if rng.uniform() < 0.15 else None
    parts = [fuse(core.shape, ripple=ripple)]
    if rng.uniform() < 0.4:
        parts.append(_dents(core, both_sides, rng))
    pieces = [core]
    for _ in range(int(rng.integers(2, 6) if both_sides else rng.integers(3, 8))):
        parent = pieces[int(rng.integers(len(pieces)))]
        root = parent.roots[int(rng.integers(len(parent.roots)))]
        size = rng.uniform(0.5, 1.0) * 0.85 ** (len(pieces) // 3)
        # Only for the core is a root still inside after it is moved to the middle plane.
        middle = both_sides and parent is core and bool(rng.uniform() < 0.45)
        piece = _grow_piece(str(rng.choice(_PIECES)), root * [1, 1, 0] if middle else root, size, middle, rng)
        shapes = both(piece.shape) if both_sides else (piece.shape,)
        parts.append(fuse(*shapes, blend=soft * size * rng.uniform(0.4, 1.2)))
        pieces.append(piece)
    return parts


def _core(rng: Rng, both_sides: bool) -> _Piece:
    radii = rng.uniform(0.24, 0.5, 3)
    turn = pitch(rng.uniform(-90, 90))
    if not both_sides:
        turn = yaw(rng.uniform(0, 360)) @ turn
    boxy = rng.uniform() < 0.25
    shape = block([0, 0, 0], radii, rng.uniform(0.05, 0.25), turn) if boxy else ball([0, 0, 0], radii, turn)
    within = rng.normal(size=(12, 3))
    within *= _INNER / np.linalg.norm(within, axis=1, keepdims=True)
    return _Piece(shape, (within * radii) @ turn.T)


def _dents(core: _Piece, both_sides: bool, rng: Rng) -> Part:
    """Return hollows around points on the core's surface, too shallow to reach its roots."""
    dents = []
    for root in core.roots[: int(rng.integers(1, 4))]:
        size = rng.uniform(0.06, 0.11)
        dents.append(ball(root / _INNER, [size, size * rng.uniform(0.8, 1.6), size]))
    return fuse(*(both(*dents) if both_sides else dents), blend=0.06, carve=True)


def _grow_piece(kind: str, root: Doubles, size: float, middle: bool, rng: Rng) -> _Piece:
    """Return a part that starts at its root and extends in a random direction."""
    way = rng.normal(size=3)
    if middle:
        way[2] = 0.0  # along the mirror plane
    way = unit(way)
    turn = yaw(rng.uniform(0, 360)) @ roll(rng.uniform(0, 360))
    if kind == "ball":
        radii = size * rng.uniform(0.3, 0.75, 3)
        centre = root + 0.7 * float(radii.min()) * way
        return _Piece(ball(centre, radii, turn), np.array([centre, centre + 0.5 * (centre - root)]))
    if kind == "block":
        half = size * rng.uniform(0.25, 0.6, 3)
        centre = root + 0.7 * float(half.min()) * way
        return _Piece(block(centre, half, size * rng.uniform(0.04, 0.15), turn), np.array([centre]))
    if kind == "ring":
        major = size * rng.uniform(0.4, 0.65)
        side = unit(np.cross(way, rng.normal(size=3)))
        axes = np.column_stack([way, side, np.cross(way, side)])
        hoop = ring(root + major * way, major, major * rng.uniform(0.22, 0.4), axes)
        return _Piece(hoop, np.array([root + 2 * major * way]))
    tip = root + size * rng.uniform(0.9, 1.4) * way
    thick = size * rng.uniform(0.14, 0.3)
    if kind == "cone":
        return _Piece(tube([root, tip], [1.6 * thick, 0.15 * thick]), np.array([root]))
    if kind == "rod":
        knob = thick * rng.uniform(0.8, 1.5)
        half_way = (root + tip) / 2
        return _Piece(tube([root, half_way, tip], [thick, thick, knob]), np.array([tip, half_way]))
    bow = np.cross(way, rng.normal(size=3)) * 0.4 * size
    curve = np.array([root, root * 0.7 + tip * 0.3 + bow, root * 0.3 + tip * 0.7 + bow, tip - 0.6 * bow])
    return _Piece(tube(curve, thick * np.array([1.1, 1.0, 0.8, 0.55])), curve[1:3])


_SHAPES: Mapping[str, Callable[[str, Rng], list[Part]]] = {
    "blob": _blob,
    "boat": _boat,
    "cactus": _cactus,
    "car": _car,
    "creature": _creature,
    "fir": _fir,
    "house": _house,
    "mug": _mug,
    "mushroom": _mushroom,
    "plane": _plane,
    "rocket": _rocket,
    "snowman": _snowman,
    "teapot": _teapot,
    "tree": _tree,
    "vase": _vase,
}
BLOBS: Mapping[str, BodyPlan] = {name: FunctionPlan(("rest",), shape) for name, shape in _SHAPES.items()}
"""All species that are neither animals nor toys."""
