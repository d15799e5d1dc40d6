"""Reptiles that crawl: one long trunk bent sideways, legs that sprawl; in units of snout to tail root."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from normalgan.animals.chain import Frame, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, carried, fuse, moved, tube
from normalgan.animals.plan import Form, Rng
from normalgan.animals.shapes import Rows, about, trunk
from normalgan.animals.spine import Spine
from normalgan.animals.sweep import Floats, Sweep

Range = tuple[float, float]


@dataclass(frozen=True)
class Crawler:
    """A kind of lizard or crocodile, belly near y = 0.

    Args:
        trunk: stations (x, top, bottom,
            half width) from the tip of the tail to the neck; the tail starts at 0.
        skull: those of the head with its upper jaw, in its own frame, in units of ``head``.
        jaw: those of the lower jaw, hinged at its first.
        head: length of the head.
        neck: (x, y) where the head is set on.
        eye: (x, y, z, radius) in units of ``head``.
        legs: (x, y, z) of the right shoulder and of the right hip.
        reach: length of a leg.
        thick: radius of a leg.
        crest: height of the spikes along the back, 0 for none.
        scutes: how many pairs of rows of bumps the back has.
        ranges: ranges of proportions that differ from the general ones.
    """

    trunk: Rows
    skull: Rows
    jaw: Rows
    head: float
    neck: tuple[float, float]
    eye: tuple[float, float, float, float]
    legs: tuple[tuple[float, float, float], tuple[float, float, float]]
    reach: float
    thick: float
    crest: float = 0.0
    scutes: int = 0
    ranges: Mapping[str, Range] = field(default_factory=dict)


RANGES: Mapping[str, Range] = {
    "girth": (0.88, 1.18), "tail": (0.8, 1.15), "head": (0.9, 1.18), "legs": (0.88, 1.15), "crest": (0.7,
            1.3),
}  # fmt: skip
POSES = ("crawl", "crawl", "stand", "bask", "gape")


def crawler(kind: Crawler) -> Form:
    """Return the body plan of a lizard or crocodile."""
    return Form(POSES, lambda pose, rng: assemble(kind, pose, rng))


def assemble(kind: Crawler, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one animal, in the order in which they blend."""
    build = {name: float(rng.uniform(*kind.ranges.get(name, RANGES[name]))) for name in RANGES}
    rows = np.array(kind.trunk)
    rows[:, 0] = np.where(rows[:, 0] < 0, rows[:, 0] * build["tail"], rows[:, 0])
    rows[:, 3] *= build["girth"]
    spine = _spine(rows, pose, rng)
    parts = [fuse(spine.trunk(rows))]
    at = spine.frame(kind.neck[0])
    lift = float(rng.uniform(0, 10)) + (8.0 if pose == "gape" else 0.0)
    turn = float(np.clip(rng.normal(0, 14), -30, 30))
    head = Frame(at.place(np.array([[0.0, kind.neck[1], 0.0]]))[0], at.rotation @ yaw(turn) @ pitch(lift))
    gape = float(rng.uniform(20, 32)) if pose == "gape" else float(rng.uniform(1, 4))
    parts += carried(_head(kind, gape), head, kind.head * build["head"])
    for number, root in enumerate(kind.legs):
        for sign in (1.0, -1.0):
            swing = float(rng.normal(0, 6))
            if pose == "crawl":  # diagonal legs go together
                swing += 26.0 * sign * (1 if number == 0 else -1) * float(rng.uniform(0.6, 1.0))
            parts.append(_leg(kind, np.array(root), sign, number == 0, swing, build["legs"], spine))
    if kind.crest:
        parts.append(fuse(*_crest(rows, kind.crest * build["crest"], spine), blend=0.015))
    if kind.scutes:
        parts.append(fuse(*_scutes(rows, kind.scutes, spine), blend=0.012))
    return parts


def _spine(rows: Floats, pose: str, rng: Rng) -> Spine:
    xs = np.linspace(rows[0, 0], rows[-1, 0] + 0.05, 41)
    share = (xs[-1] - xs) / (xs[-1] - xs[0])
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    if pose == "crawl":
        turns = (
            side * (14 + 34 * share) * np.sin(2 * np.pi * (1.15 * share + float(rng.uniform(-0.08, 0.08))))
        )
    elif pose == "bask":  # curled to one side, the tail most of all
        turns = side * float(rng.uniform(90, 165)) * share**1.8
    else:
        turns = side * float(rng.uniform(0, 40)) * share**1.3 + float(rng.normal(0, 10)) * np.sin(5 * share)
    return Spine(xs, turns - turns[-1])


def _head(kind: Crawler, gape: float) -> list[Part]:
    x, y, z, radius = kind.eye
    jaw = np.array(kind.jaw)
    hinge = (jaw[0, 0], (jaw[0, 1] + jaw[0, 2]) / 2, 0.0)
    nose = np.array(kind.skull)[-1]
    nostril = tube(
        [(nose[0], nose[1], 0.55 * nose[3]), (nose[0] - 0.05, nose[1] + 0.015, 0.6 * nose[3])], 0.022
    )
    return [
        fuse(trunk(kind.skull), blend=0.18),
        fuse(moved(trunk(jaw), about(hinge, pitch(-gape))), blend=0.02),
        fuse(*both(ball((x, y, z), radius)), blend=0.03),
        fuse(*both(nostril), blend=0.01, carve=True),
    ]


def _leg(
    kind: Crawler, root: Floats, sign: float, fore: bool, swing: float, factor: float, spine: Spine
) -> Part:
    """Return a leg: out from the flank, down from the elbow or knee, the foot flat on the ground."""
    x, y, z = root
    reach, r = kind.reach * factor, kind.thick
    back = -1.0 if fore else 1.0  # elbows point backwards, knees forwards
    ground = -r * 0.4
    elbow = np.array([0.22 * back * reach, y + 0.10 * reach, z + 0.44 * reach])
    foot = np.array([0.06 * reach, ground + 0.5 * r, z + 0.66 * reach])
    pivot = np.array([0.0, 0.0, z])
    turn = about(pivot, yaw(swing))
    joint, foot = turn.place(np.array([elbow, foot]))
    parts = [tube([(0, y, 0.7 * z), (0, y, z), joint, foot], [1.35 * r, 1.3 * r, 0.95 * r, 0.72 * r])]
    for spread in (-58.0, -28.0, 0.0, 26.0, 52.0):
        length = (0.30 if abs(spread) < 40 else 0.22) * reach
        way = yaw(swing - 38.0 + spread) @ np.array([length, 0.0, 0.0])
        tip = foot + way
        middle = foot + 0.55 * way + [0.0, 0.25 * r, 0.0]
        tip[1], middle[1] = ground + 0.1 * r, max(middle[1], ground + 0.4 * r)
        parts.append(tube([foot, middle, tip], [0.55 * r, 0.42 * r, 0.22 * r]))
    shape = fuse(*parts, blend=0.05)
    flip = Frame(np.zeros(3), np.diag([1.0, 1.0, sign]))
    return carried(carried([shape], flip), spine.frame(x))[0]


def _crest(rows: Floats, height: float, spine: Spine) -> list[Sweep]:
    spikes = []
    for x in np.arange(rows[-1, 0] - 0.02, 0.45 * rows[0, 0], -0.055):
        top = float(np.interp(x, rows[:, 0], rows[:, 1]))
        tall = height * float(np.interp(x, [0.4 * rows[0, 0], 0.0, 0.7], [0.3, 0.7, 1.0]))
        points = np.array([[x + 0.02, top - 0.02, 0.0], [x - 0.03, top + tall, 0.0]])
        spikes.append(tube(spine.place(points), [0.030, 0.010], [0.014, 0.008]))
    return spikes


def _scutes(rows: Floats, pairs: int, spine: Spine) -> list[Sweep]:
    bumps = []
    for x in np.arange(rows[-1, 0] - 0.02, 0.8 * rows[0, 0], -0.062):
        top, bottom, wide = (float(np.interp(x, rows[:, 0], column)) for column in rows.T[1:])
        tail = x < 0.45 * rows[0, 0]  # the two inner rows run together on the tail
        for k in range(1 if tail else pairs):
            share = 0.0 if tail else (0.24 + 0.46 * k / max(pairs - 1, 1))
            y = (top + bottom) / 2 + (top - bottom) / 2 * np.sqrt(1 - share**2)
            for sign in (1.0,) if tail else (1.0, -1.0):
                z = sign * share * wide
                points = np.array([[x + 0.018, y - 0.006, z], [x - 0.018, y + (0.028 if tail else 0.012), z]])
                bumps.append(tube(spine.place(points), [0.020, 0.012], [0.015, 0.010]))
    return bumps
