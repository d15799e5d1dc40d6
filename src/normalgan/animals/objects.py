"""Things with a name, each a function: vessels, cars, craft, what stands in a garden, plants."""

from collections.abc import Callable, Mapping

import numpy as np

from normalgan.animals.blobs import blob, creature
from normalgan.animals.frames import pitch, roll, yaw
from normalgan.animals.parts import Part, Ripple, ball, block, both, by, fuse, pair, ring, tube
from normalgan.animals.plan import BodyPlan, Form, Rng, factors
from normalgan.animals.shapes import Shape

__all__ = ["BLOBS", "turned"]

_VESSELS = ("belly", "bottle", "flute", "goblet", "bowl")


def turned(heights: list[float], radii: list[float], wall: float) -> list[Part]:
    """Return an open vessel on a flat foot.

    Args:
        heights: stations from the foot up, the last one the rim.
        radii: of its outside at these.
        wall: thickness.
    """
    rows = [(0.0, y) for y in reversed(heights)]
    outer = tube(rows, radii[::-1])
    top, rim = heights[-1], radii[-1]
    thin = [y for y, r in zip(heights, radii, strict=True) if y > wall and r <= 2.4 * wall and y < 0.6 * top]
    floor = max([wall, *thin])  # a stem is not hollow
    bulb = 0.5 * max(float(np.interp(floor, heights, radii)), 2 * wall)
    inside = [(y, r - wall) for y, r in zip(heights, radii, strict=True) if y > floor + 1.5 * bulb]
    hollow = [(floor + bulb, bulb), *inside, (top + 0.3, rim - wall)]
    lid = block((0, top + 1.0), [2.0, 1.0, 2.0], 0.01)
    return [
        fuse(outer),
        fuse(tube([(0, y) for y, _ in hollow], [r for _, r in hollow]), lid, carve=True, blend=0.01),
        _level(heights[0]),
    ]


def _level(height: float) -> Part:
    """Return what takes away all below a height: a flat foot."""
    return fuse(block((0, height - 1.0), [2.0, 1.0, 2.0], 0.01), carve=True)


def _vase(pose: str, rng: Rng) -> list[Part]:
    """Return a vase, bottle, bowl or goblet, with two handles on some."""
    f = factors(rng, 0.2, "foot", "belly", "neck", "lip", "tall")
    kind = str(rng.choice(_VESSELS))
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
        out = radii[2] + rng.uniform(0.0, 0.12)
        loop = [
            [0, low, 0.85 * radii[2]],
            [0, (low + high) / 2 + 0.1, out + 0.02],
            [0, high + 0.03, 0.8 * out],
            [0, high, radii[4] - 0.01],
        ]
        parts.append(pair(tube(loop, 0.032), blend=0.015))
    if rng.uniform() < 0.4:
        at = heights[3]
        parts.append(fuse(ring((0, at), radii[3] * 1.0, 0.025), blend=0.01))
    return parts


def _bowl(wide: float, deep: float, foot: float) -> list[Part]:
    wall = 0.045
    lid = block((0, deep + 1.0), [2.0, 1.0, 2.0], 0.01)
    return [
        fuse(ball((0, deep), [wide, deep, wide])),
        fuse(tube([(0, 0.08), (0, -0.02)], [0.8 * foot, foot]), blend=0.04),
        _level(-0.03),
        fuse(
            ball((0, deep + wall), [wide - wall, deep - 0.5 * wall, wide - wall]), lid, carve=True, blend=0.01
        ),
    ]


def _mug(pose: str, rng: Rng) -> list[Part]:
    """Return a mug, its handle at the back."""
    f = factors(rng, 0.2, "tall", "wide", "taper", "handle")
    tall, wide = 0.75 * f["tall"], 0.30 * f["wide"]
    rim = wide * (1 + 0.6 * (f["taper"] - 1))
    parts = turned([0.0, 0.06, 0.35 * tall, 0.7 * tall, tall], [0.94 * wide, wide, wide, rim, rim], 0.05)
    out = 0.26 * f["handle"]
    loop = [
        (-wide + 0.02, 0.78 * tall),
        (-wide - 0.8 * out, 0.80 * tall),
        (-wide - out, 0.5 * tall),
        (-wide - 0.6 * out, 0.2 * tall),
        (-wide + 0.02, 0.2 * tall),
    ]
    parts.append(fuse(tube(loop, 0.042, 0.06), blend=0.025))
    if rng.uniform() < 0.4:
        bands: list[Shape] = [ring((0, y * tall), wide, 0.02) for y in (0.15, 0.85)]
        parts.append(fuse(*bands, blend=0.01))
    return parts


def _teapot(pose: str, rng: Rng) -> list[Part]:
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
        fuse(ball((0, 0.04 + tall), [wide, tall, wide])),
        fuse(tube([(0, 0.10), (0, 0.0)], [0.5 * wide, 0.62 * wide], flat=True), blend=0.03),
        fuse(tube(spout, [0.145, 0.10, 0.075, 0.066], flat=True), blend=0.05),
        fuse(tube([mouth - 0.05 * aim, mouth + 0.1 * aim], 0.032), carve=True),
        fuse(tube(handle, 0.038, 0.05), blend=0.03),
        fuse(ring((0, high + 0.05 * tall), 0.52 * wide, 0.03), blend=0.02),
        fuse(ball((0, high + 0.05 * tall), [0.5 * wide, 0.26 * tall, 0.5 * wide]), blend=0.01),
        fuse(
            ball((0, high + 0.42 * tall), 0.065 * f["knob"]),
            tube([(0, high), (0, high + 0.4 * tall)], 0.035),
            blend=0.02,
        ),
        _level(-0.03),
    ]


def _car(pose: str, rng: Rng) -> list[Part]:
    """Return a toy car: sedan, van, truck or racer."""
    f = factors(rng, 0.14, "long", "wide", "high", "wheel")
    kind = str(rng.choice(("sedan", "beetle", "van", "truck", "racer")))
    long, wide, wheel = 0.52 * f["long"], 0.23 * f["wide"], 0.12 * f["wheel"]
    low, high = 0.10 * f["high"], 0.13 * f["high"]
    floor = wheel + low
    edge = rng.uniform(0.04, 0.09)
    parts = [fuse(block((0, floor), [long, low, wide], edge))]
    if kind == "beetle":
        parts.append(
            fuse(ball((-0.05, floor + 0.4 * low), [0.75 * long, 2.2 * high, 0.92 * wide]), blend=0.05)
        )
        cabin, panes = -0.05, 0.28 * long
    elif kind == "van":
        parts.append(
            fuse(block((-0.08, floor + low + 0.7 * high), [0.82 * long, 1.3 * high, 0.97 * wide], edge))
        )
        cabin, panes = 0.0, 0.45 * long
    elif kind == "truck":
        parts.append(
            fuse(block((0.55 * long, floor + low + 0.6 * high), [0.33 * long, 1.2 * high, 0.95 * wide], edge))
        )
        bed = block((-0.40 * long, floor + low + 0.3 * high), [0.56 * long, 0.6 * high, 0.98 * wide], 0.03)
        load = block((-0.40 * long, floor + low + 0.8 * high), [0.48 * long, 0.8 * high, 0.8 * wide], 0.02)
        parts += [fuse(bed), fuse(load, carve=True)]
        cabin, panes = 0.55 * long, 0.15 * long
    elif kind == "racer":
        nose = tube(
            [(0.3 * long, floor), (1.35 * long, floor - 0.3 * low)],
            [low, 0.5 * low],
            [0.9 * wide, 0.35 * wide],
        )
        parts.append(fuse(nose, blend=0.05))
        parts.append(fuse(ball((-0.1, floor + low), [0.12, 0.13, 0.1]), blend=0.03))
        vane = block((-0.95 * long, floor + 2.6 * low), [0.09, 0.022, 1.1 * wide], 0.02)
        posts = both(
            tube([[-0.9 * long, floor, 0.6 * wide], [-0.95 * long, floor + 2.6 * low, 0.6 * wide]], 0.025)
        )
        parts += [fuse(vane, *posts)]
        cabin, panes = 0.0, 0.0
    else:
        parts.append(
            fuse(
                tube(
                    [
                        (0.42 * long, floor + low),
                        (0.12 * long, floor + low + high),
                        (-0.42 * long, floor + low + high),
                        (-0.68 * long, floor + low),
                    ],
                    0.55 * high,
                    0.88 * wide,
                ),
                block((-0.13 * long, floor + low + 0.5 * high), [0.45 * long, 0.8 * high, 0.86 * wide], 0.04),
                blend=0.03,
            )
        )
        cabin, panes = -0.08, 0.26 * long
    if panes:
        pane = floor + low + 0.85 * high
        parts.append(
            pair(block([cabin, pane, wide], [panes, 0.45 * high, 0.06], 0.02), carve=True, blend=0.01)
        )
    axles = (0.62 * long, -0.62 * long)
    arches = both(*(ball([x, wheel, wide], [1.25 * wheel, 1.25 * wheel, 0.09]) for x in axles))
    tyres = both(*(ball([x, wheel, wide - 0.01], [wheel, wheel, 0.075]) for x in axles))
    hubs = both(*(ball([x, wheel, wide + 0.07], [0.5 * wheel, 0.5 * wheel, 0.03]) for x in axles))
    rods = [tube([[x, wheel, -wide], [x, wheel, wide]], 0.35 * wheel) for x in axles]
    parts += [fuse(*arches, carve=True), fuse(*tyres, *rods), fuse(*hubs, carve=True, blend=0.01)]
    lamps: tuple[Shape, ...] = both(
        ball([long - 0.005, floor + 0.2 * low, 0.62 * wide], [0.03, 0.045, 0.045])
    )
    bumper = tube(
        [[long, floor - 0.6 * low, -0.9 * wide], [long + 0.02, floor - 0.6 * low, 0.9 * wide]], 0.035
    )
    return [*parts, fuse(*lamps, blend=0.01), fuse(bumper, blend=0.01)]


def _boat(pose: str, rng: Rng) -> list[Part]:
    """Return a boat with sails or a funnel."""
    f = factors(rng, 0.16, "long", "wide", "deep", "mast")
    long, wide, deep = 0.52 * f["long"], 0.20 * f["wide"], 0.22 * f["deep"]
    hull = ball((0, 0), [long, deep, wide])
    bow = tube([(0.45 * long, -0.4 * deep), (1.05 * long, 0.06)], [0.5 * deep, 0.06], [0.45 * wide, 0.03])
    deck = block((0, 0.5), [1.5, 0.5, 1.0], 0.01)
    parts = [
        fuse(hull),
        fuse(bow, blend=0.08),
        fuse(deck, carve=True),
        fuse(ball((0, 0.02), [0.85 * long, 0.5 * deep, 0.8 * wide]), carve=True, blend=0.02),
    ]
    if rng.uniform() < 0.5:
        top = 0.95 * f["mast"]
        mast = tube([(0.05, -0.9 * deep), (0.05, top)], [0.035, 0.025])
        boom = tube([[0.05, 0.12, 0], [-0.85 * long, 0.12, 0.03]], 0.024)
        rows = np.linspace(0.13, 0.95 * top, 6)
        span = 0.85 * long * (1 - (rows - 0.13) / (0.92 * top))
        mids = np.column_stack([0.05 - span / 2, rows, 0.02 * np.sin(3 * rows)])
        main = tube(mids, 0.02, span / 2 + 0.01, (1, 0, 0))
        jib_span = 0.85 * long * (1 - (rows - 0.1) / (0.95 * top))
        jib = tube(
            np.column_stack([0.08 + jib_span / 2, rows, 0 * rows]), 0.02, jib_span / 2 + 0.005, (1, 0, 0)
        )
        return [*parts, fuse(mast, boom), fuse(main, jib)]
    house = block((-0.1 * long, 0.06), [0.4 * long, 0.22, 0.6 * wide], 0.04)
    bridge = block((0.05 * long, 0.28), [0.2 * long, 0.12, 0.5 * wide], 0.03)
    stacks = [
        tube([(x * long, 0.1), ((x - 0.05) * long, 0.5 * f["mast"])], 0.055, flat=True)
        for x in (-0.15, -0.38)
    ]
    holes = [ball([x * long, 0.16, 0.6 * wide], [0.04, 0.04, 0.03]) for x in (-0.35, -0.1, 0.15)]
    keel = fuse(tube([(-0.3 * long, -0.75 * deep), (-0.1 * long, 0.0)], 0.05), blend=0.02)
    return [*parts, keel, fuse(house, blend=0.01), fuse(bridge), fuse(*stacks), pair(*holes, carve=True)]


def _plane(pose: str, rng: Rng) -> list[Part]:
    """Return a toy aeroplane with jets or a propeller."""
    f = factors(rng, 0.16, "long", "fat", "span", "tail")
    fat, span = 0.115 * f["fat"], 0.62 * f["span"]
    rear = -0.62 * f["long"]
    back, up = rng.uniform(0.0, 0.32), rng.uniform(-0.02, 0.10)
    hull = tube(
        [(rear, 0.06), (-0.3, 0.02), (0.1, 0), (0.38, 0), (0.5, -0.01)],
        np.array([0.3, 0.85, 1.0, 0.9, 0.55]) * fat,
    )
    wings = tube([[0.05, -0.02, 0.0], [0.05 - back, up, span]], [0.032, 0.02], [0.17, 0.085], (1, 0, 0))
    fins = tube(
        [[rear + 0.06, 0.06, 0], [rear - 0.02, 0.07, 0.26 * f["tail"]]], 0.02, [0.10, 0.055], (1, 0, 0)
    )
    rudder = tube([(rear + 0.07, 0.05), (rear - 0.05, 0.30 * f["tail"])], 0.02, [0.11, 0.06], (1, 0, 0))
    parts = [
        fuse(hull),
        fuse(*both(wings, fins), rudder, blend=0.03),
        fuse(ball((0.25, 0.75 * fat), [0.14, 0.6 * fat, 0.6 * fat]), blend=0.015),
    ]
    if rng.uniform() < 0.5:
        tip = 0.5 + 0.5 * fat
        blades = tube([(tip, 0.30), (tip, 0), (tip, -0.30)], 0.02, [0.045, 0.025, 0.045])
        return [*parts, fuse(tube([(0.45, 0), (tip + 0.03, 0)], 0.045), blades, blend=0.01)]
    pods = [
        tube([[0.10 - 0.5 * back * k, -0.075, k * span], [-0.08 - 0.5 * back * k, -0.075, k * span]], 0.055)
        for k in (0.4, 0.68)[: int(rng.integers(1, 3))]
    ]
    return [*parts, pair(*pods, blend=0.02)]


def _rocket(pose: str, rng: Rng) -> list[Part]:
    """Return a rocket on its fins."""
    f = factors(rng, 0.18, "tall", "fat", "fins")
    tall, fat = 1.0 * f["tall"], 0.16 * f["fat"]
    hull = tube(
        [(0, tall), (0, 0.72 * tall), (0, 0.4 * tall), (0, 0.1)],
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
        fuse(tube([(0, 0.15), (0, 0.02)], [0.5 * fat, 0.72 * fat], flat=True), blend=0.01),
    ]
    eye = (0.95 * fat, 0.66 * tall)
    parts += [fuse(ball(eye, 0.4 * fat), carve=True), fuse(ring(eye, 0.42 * fat, 0.025, pitch(-90)))]
    return [*parts, fuse(ring((0, 0.72 * tall), 0.86 * fat, 0.014), blend=0.01)]


def _snowman(pose: str, rng: Rng) -> list[Part]:
    """Return a snowman: two or three balls, a carrot, sticks, a hat on some."""
    f = factors(rng, 0.14, "low", "middle", "head", "nose")
    sizes = [0.33 * f["low"], 0.24 * f["middle"], 0.17 * f["head"]]
    if rng.uniform() < 0.3:
        sizes.pop(1)
    parts, y = [], 0.0
    for size in sizes:
        y += 0.80 * size
        parts.append(fuse(ball((0, y), [size, 0.95 * size, size]), blend=0.02))
        middle, y = y, y + 0.80 * size
    head = sizes[-1]
    belly = middle - 0.8 * head - 0.72 * sizes[-2]
    nose = tube([(0.8 * head, middle), (head + 0.20 * f["nose"], middle - 0.02)], [0.05, 0.014])
    buttons = [ball((sizes[-2] * np.cos(a), belly + sizes[-2] * np.sin(a)), 0.034) for a in (0.0, 0.4)]
    up = rng.uniform(0.0, 0.35)
    arm = [
        [0, belly + 0.05, 0.5 * sizes[-2]],
        [0.03, belly + 0.12, sizes[-2] + 0.14],
        [0.05, belly + 0.1 + up, sizes[-2] + 0.32],
    ]
    twig = [arm[1], [0.05, belly + 0.24 + 0.3 * up, sizes[-2] + 0.24]]
    eyes = both(ball([0.84 * head, middle + 0.35 * head, 0.36 * head], 0.028))
    parts += [fuse(nose, blend=0.01), fuse(*buttons, *eyes), pair(tube(arm, 0.022), tube(twig, 0.018))]
    if rng.uniform() < 0.7:
        brim = middle + 0.75 * head
        parts.append(fuse(ball((0, brim), [1.25 * head, 0.03, 1.25 * head])))
        crown = tube([(0, brim), (0, brim + rng.uniform(0.14, 0.28))], [0.72 * head, 0.75 * head], flat=True)
        parts.append(fuse(crown, blend=0.01))
    if rng.uniform() < 0.5:
        parts.append(fuse(ring((0, middle - 0.78 * head), 0.72 * head, 0.05, roll(5)), blend=0.02))
    return parts


def _house(pose: str, rng: Rng) -> list[Part]:
    """Return a small house: gabled roof, door, windows, chimney."""
    f = factors(rng, 0.18, "long", "wide", "high")
    deep, wide, high = 0.30 * f["wide"], 0.36 * f["long"], 0.26 * f["high"]
    steep = rng.uniform(32, 52)
    slant = deep / np.cos(np.deg2rad(steep)) + 0.09
    ridge = 2 * high + deep * np.tan(np.deg2rad(steep))
    walls = [block((0, high), [deep, high, wide], 0.015)]
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
    door = block([deep, 0.55 * high, rng.uniform(-0.4, 0.4) * wide], [0.05, 0.55 * high, 0.075], 0.015)
    panes: list[Shape] = [
        block([deep, 1.3 * high, s * 0.62 * wide], [0.04, 0.2 * high, 0.065], 0.01) for s in (1, -1)
    ]
    panes += both(block([0.0, 1.15 * high, wide], [0.09, 0.28 * high, 0.04], 0.01))
    stack = [-0.4 * deep, ridge - 0.3 * deep, float(rng.choice((-1, 1))) * 0.55 * wide]
    chimney = block(stack, [0.055, 0.55 * deep + 0.08, 0.055], 0.012)
    return [fuse(*walls, *gable), fuse(*roof), fuse(door, *panes, carve=True), fuse(chimney)]


def _tree(pose: str, rng: Rng) -> list[Part]:
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
        turn = yaw(rng.uniform(-15, 15) + 72 * i)
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
        crown.append(ball(at, wide * rng.uniform(0.45, 0.68)))
        boughs.append(tube([top * 0.75, at], 0.4 * thick))
    leaves = Ripple(0.012, 0.13) if rng.uniform() < 0.6 else None
    parts.append(fuse(*boughs, blend=0.03))
    parts += [fuse(clump, blend=0.05, ripple=leaves) for clump in crown]
    return parts


def _fir(pose: str, rng: Rng) -> list[Part]:
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
        skirt = tube([(0, tip), (0, low - 0.5 * big)], [0.02, 1.25 * big])
        parts += [fuse(skirt, blend=0.015), _level(low)]
    parts.append(fuse(tube([(0, 0.9), (0, 0.0)], 0.07 * f["trunk"], flat=True)))
    if rng.uniform() < 0.4:
        pot = tube([(0, 0.06), (0, -0.16)], [0.17, 0.12], flat=True)
        parts.append(fuse(pot, blend=0.01))
    return parts


def _cactus(pose: str, rng: Rng) -> list[Part]:
    """Return a cactus with arms, ribbed, in a pot on some."""
    f = factors(rng, 0.2, "tall", "thick", "arms")
    tall, thick = 0.85 * f["tall"], 0.13 * f["thick"]
    column = tube([(0, 0.0), (0, 0.5 * tall), (0, tall)], [0.9 * thick, 1.05 * thick, 0.85 * thick])
    parts = [fuse(column)]
    arms = []
    for i in range(int(rng.integers(1, 4))):
        turn = yaw(90 + 180 * i + rng.uniform(-25, 25))
        low, out = tall * rng.uniform(0.25, 0.6), thick + 0.18 * f["arms"]
        up = low + 0.30 * f["arms"] * rng.uniform(0.5, 1.2)
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
        bowl = tube([(0, 0.08), (0, -0.2)], [2.0 * thick, 1.4 * thick], flat=True)
        parts += [fuse(bowl, blend=0.01), fuse(ring((0, 0.12), 1.95 * thick, 0.04), blend=0.01)]
    return parts


def _mushroom(pose: str, rng: Rng) -> list[Part]:
    """Return a mushroom, with a small one beside it or a collar on some."""
    parts = _one_mushroom(rng, np.zeros(3), 1.0, blend=0.0)
    if rng.uniform() < 0.4:
        at = np.array([0.10, 0.0, float(rng.choice((-1, 1))) * 0.12])
        parts += _one_mushroom(rng, at, rng.uniform(0.45, 0.6), blend=0.03, lean=0.15)
    return parts


def _one_mushroom(rng: Rng, at: np.ndarray, size: float, blend: float, lean: float = 0.0) -> list[Part]:
    f = factors(rng, 0.22, "tall", "stem", "cap", "high")
    stem, tall = 0.10 * f["stem"] * size, 0.62 * f["tall"] * size
    wide, high = 0.38 * f["cap"] * size, 0.30 * f["high"] * size
    away = at * lean * 8 + rng.uniform(-0.05, 0.05, 3) * [1, 0, 1]
    top = by(at, 0, tall, 0) + away
    cap = ball(top, [wide, high, wide])
    hollow = ball(top - [0, 0.62 * high, 0], [0.86 * wide, 0.62 * high, 0.86 * wide])
    stalk = tube(
        [by(at, 0, 0.0, 0), by(at, 0, 0.3 * tall, 0) + 0.3 * away, by(top, 0, 0.3 * high, 0)],
        [1.7 * stem, stem, 0.9 * stem],
    )
    dome = [fuse(cap, blend=blend), fuse(hollow, blend=0.04 * size, carve=True)]
    parts = [*dome, fuse(stalk, blend=0.02 * size)]
    if rng.uniform() < 0.4:
        spots = []
        for _ in range(9):
            a, e = rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(25, 90))
            ray = np.array([np.cos(a) * np.cos(e), np.sin(e), np.sin(a) * np.cos(e)])
            spots.append(ball(top + ray * [wide, high, wide], 0.05 * size * rng.uniform(0.7, 1.3)))
        parts.append(fuse(*spots, blend=0.03 * size))
    return parts


_SHAPES: Mapping[str, Callable[[str, Rng], list[Part]]] = {
    "blob": blob,
    "boat": _boat,
    "cactus": _cactus,
    "car": _car,
    "creature": creature,
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
BLOBS: Mapping[str, BodyPlan] = {name: Form(("rest",), shape) for name, shape in _SHAPES.items()}
"""All that is neither animal nor toy."""
