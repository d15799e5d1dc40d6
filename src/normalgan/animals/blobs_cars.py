"""Toy cars: sedan, beetle, van, truck, racer."""

from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, ball, block, both, fuse, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def car(pose: str, rng: Rng) -> list[Part]:
    """Return a toy car: sedan, van, truck or racer."""
    f = factors(rng, 0.14, "long", "wide", "high", "wheel")
    kind = str(rng.choice(("sedan", "beetle", "van", "truck", "racer")))
    long, wide, wheel = 0.52 * f["long"], 0.23 * f["wide"], 0.12 * f["wheel"]
    low, high = 0.10 * f["high"], 0.13 * f["high"]
    floor = wheel + low
    edge = float(rng.uniform(0.04, 0.09))
    parts = [fuse(block([0, floor, 0], [long, low, wide], edge))]
    if kind == "beetle":
        parts.append(
            fuse(ball([-0.05, floor + 0.4 * low, 0], [0.75 * long, 2.2 * high, 0.92 * wide]), blend=0.05)
        )
        cabin, panes = -0.05, 0.28 * long
    elif kind == "van":
        parts.append(
            fuse(block([-0.08, floor + low + 0.7 * high, 0], [0.82 * long, 1.3 * high, 0.97 * wide], edge))
        )
        cabin, panes = 0.0, 0.45 * long
    elif kind == "truck":
        parts.append(
            fuse(
                block(
                    [0.55 * long, floor + low + 0.6 * high, 0], [0.33 * long, 1.2 * high, 0.95 * wide], edge
                )
            )
        )
        bed = block([-0.40 * long, floor + low + 0.3 * high, 0], [0.56 * long, 0.6 * high, 0.98 * wide], 0.03)
        load = block([-0.40 * long, floor + low + 0.8 * high, 0], [0.48 * long, 0.8 * high, 0.8 * wide], 0.02)
        parts += [fuse(bed), fuse(load, carve=True)]
        cabin, panes = 0.55 * long, 0.15 * long
    elif kind == "racer":
        nose = tube(
            [[0.3 * long, floor, 0], [1.35 * long, floor - 0.3 * low, 0]],
            [low, 0.5 * low],
            [0.9 * wide, 0.35 * wide],
        )
        parts.append(fuse(nose, blend=0.05))
        parts.append(fuse(ball([-0.1, floor + low, 0], [0.12, 0.13, 0.1]), blend=0.03))
        vane = block([-0.95 * long, floor + 2.6 * low, 0], [0.09, 0.022, 1.1 * wide], 0.02)
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
                        [0.42 * long, floor + low, 0],
                        [0.12 * long, floor + low + high, 0],
                        [-0.42 * long, floor + low + high, 0],
                        [-0.68 * long, floor + low, 0],
                    ],
                    0.55 * high,
                    0.88 * wide,
                ),
                block(
                    [-0.13 * long, floor + low + 0.5 * high, 0], [0.45 * long, 0.8 * high, 0.86 * wide], 0.04
                ),
                blend=0.03,
            )
        )
        cabin, panes = -0.08, 0.26 * long
    if panes:
        pane = floor + low + 0.85 * high
        parts.append(
            fuse(*both(block([cabin, pane, wide], [panes, 0.45 * high, 0.06], 0.02)), carve=True, blend=0.01)
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
