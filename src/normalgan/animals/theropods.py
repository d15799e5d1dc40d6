"""Dinosaurs that go on two legs: a level trunk, a long tail, jaws, small arms; in units of hip to chest."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from normalgan.animals.bird_legs import LegShape, legs
from normalgan.animals.chain import Frame, bend, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, carried, fuse, moved, tube
from normalgan.animals.outline import rounded
from normalgan.animals.plan import Form, Rng
from normalgan.animals.plate import Plate
from normalgan.animals.shapes import Rows, about, trunk
from normalgan.animals.spine import Spine
from normalgan.animals.sweep import Floats, Sweep

Range = tuple[float, float]


@dataclass(frozen=True)
class Theropod:
    """A kind of two-legged dinosaur.

    Args:
        torso: stations (x, top, bottom, half width) from the root of the tail to the chest, the hip at 0.
        tail: those of the tail, from its tip into the torso.
        neck: stations (x, y, radius) from inside the chest to the head.
        skull: stations (x, top, bottom, half width) of head and upper jaw, in units of ``length``.
        jaw: those of the lower jaw, hinged at its first.
        length: of the head.
        eye: (x, y, z, radius) in units of ``length``.
        arm: (x, y, z, length, radius) of the right arm at the shoulder.
        leg: the legs.
        crest: horns over the eyes: their height in units of ``length``, 0 for none.
        sail: height of a sail on the back, 0 for none.
        pitch: degrees by which the trunk is raised.
        ranges: ranges of proportions that differ from the general ones.
    """

    torso: Rows
    tail: Rows
    neck: Rows
    skull: Rows
    jaw: Rows
    length: float
    eye: tuple[float, float, float, float]
    arm: tuple[float, float, float, float, float]
    leg: LegShape
    crest: float = 0.0
    sail: float = 0.0
    pitch: Range = (-4.0, 16.0)
    ranges: Mapping[str, Range] = field(default_factory=dict)


RANGES: Mapping[str, Range] = {
    "girth": (0.88, 1.15), "tail": (0.85, 1.12), "neck": (0.88, 1.12), "head": (0.88, 1.15),
    "arm": (0.85, 1.2), "legs": (0.9, 1.08), "sail": (0.75, 1.2),
}  # fmt: skip
YOUNG: Mapping[str, float] = {"head": 1.3, "neck": 0.85, "tail": 0.85, "girth": 0.95, "legs": 1.08}
YOUNG_SHARE = 0.12
POSES = ("stand", "stand", "walk", "walk", "run", "roar")


def theropod(kind: Theropod) -> Form:
    """Return the body plan of a two-legged dinosaur."""
    return Form(POSES, lambda pose, rng: assemble(kind, pose, rng))


def assemble(kind: Theropod, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one dinosaur, in the order in which they blend."""
    young = bool(rng.uniform() < YOUNG_SHARE)
    build = {name: float(rng.uniform(*kind.ranges.get(name, RANGES[name]))) for name in RANGES}
    build = {name: value * (YOUNG.get(name, 1.0) if young else 1.0) for name, value in build.items()}
    tilt = float(rng.uniform(*kind.pitch)) + {"run": -5.0, "roar": 14.0}.get(pose, 0.0)
    whole = about((0, 0, 0), pitch(tilt))
    torso, tail = np.array(kind.torso), np.array(kind.tail)
    torso[:, 3] *= build["girth"]
    tail[:, 0] *= build["tail"]
    parts = [fuse(moved(trunk(torso), whole)), fuse(_tail(tail, tilt, rng), blend=0.12)]
    neck = np.array(kind.neck)
    points = np.column_stack([neck[:, :2], np.zeros(len(neck))])
    points = whole.place(points[0] + (points - points[0]) * build["neck"])
    aside = float(np.clip(rng.normal(0, 13), -30, 30))
    bent, _ = bend(points, float(rng.uniform(-8, 8)) + (10.0 if pose == "roar" else -0.3 * tilt), aside)
    parts.append(fuse(tube(bent, list(neck[:, 2] * np.linspace(1, build["head"], len(neck)))), blend=0.15))
    nod = float(rng.uniform(-14, 2)) + (16.0 if pose == "roar" else 0.0)
    head = Frame(bent[-1], yaw(1.4 * aside) @ pitch(nod))
    gape = float(rng.uniform(24, 36) if pose == "roar" else rng.choice([4.0, 6.0, 18.0]))
    parts += carried(_head(kind, gape), head, kind.length * build["head"])
    parts += carried(_arms(kind, build["arm"], rng), whole)
    if kind.sail:
        parts += carried(_sail(torso, kind.sail * build["sail"]), whole)
    stride = "walk" if pose == "run" else "stand" if pose == "roar" else pose
    return parts + legs(kind.leg, build["legs"], stride, whole, rng)


def _tail(rows: Floats, tilt: float, rng: Rng) -> Sweep:
    xs = np.linspace(rows[0, 0], 0.0, 17)
    behind = xs / xs[0]
    sway = float(rng.normal(0, 32)) * behind + float(rng.normal(0, 24)) * np.sin(2 * np.pi * behind)
    spine = Spine(xs, sway - sway[-1])
    lifted = rows.copy()
    # The root is turned with the trunk, the rest stays level or is carried a little high.
    drop = np.tan(np.deg2rad(tilt)) * np.maximum(rows[:, 0], -0.35) + float(rng.uniform(-0.1, 0.22)) * (
        np.minimum(rows[:, 0] + 0.5, 0) ** 2
    )
    lifted[:, 1:3] += drop[:, None]
    sweep = spine.trunk(lifted)
    root = spine.frame(0.0).origin
    return replace(sweep, points=sweep.points - root)


def _head(kind: Theropod, gape: float) -> list[Part]:
    """Return the head in its own frame and unit."""
    x, y, z, radius = kind.eye
    jaw = np.array(kind.jaw)
    hinge = (jaw[0, 0], (jaw[0, 1] + jaw[0, 2]) / 2, 0.0)
    brow = tube([(x - 0.10, y + radius, 0.9 * z), (x + 0.10, y + 0.9 * radius, 0.95 * z)], [0.045, 0.035])
    nose = np.array(kind.skull)[-1]
    nostril = tube(
        [(nose[0] + 0.01, nose[1] * 0.7, nose[3] * 0.9), (nose[0] - 0.05, nose[1] * 0.85, nose[3])], 0.022
    )
    parts = [
        fuse(trunk(kind.skull), blend=0.20),
        fuse(moved(trunk(jaw), about(hinge, pitch(-gape))), blend=0.03),
        fuse(*both(brow), blend=0.05),
        fuse(*both(ball((x, y, z), radius))),
        fuse(*both(nostril), blend=0.01, carve=True),
    ]
    if kind.crest:
        horn = tube([(x, y + 0.02, 0.8 * z), (x + 0.02, y + 0.1 + kind.crest, 0.95 * z)], [0.075, 0.02])
        parts.append(fuse(*both(horn), blend=0.04))
    return parts


def _arms(kind: Theropod, factor: float, rng: Rng) -> list[Part]:
    x, y, z, length, radius = kind.arm
    length *= factor
    parts = []
    for sign in (1.0, -1.0):
        swing = pitch(float(rng.normal(0, 14)))
        shoulder = np.array([x, y, z])
        bones = np.array([[0, 0, 0], [-0.25, -0.42, 0.10], [0.12, -0.60, 0.10], [0.26, -0.66, 0.06]]) * length
        points = shoulder + bones @ swing.T
        arm = tube(points, [1.5 * radius, radius, 0.75 * radius, 0.8 * radius])
        claws = []
        for spread in (-0.09, 0.0, 0.09):
            reach = np.array([[0, 0, 0], [0.16, -0.02, spread], [0.26, -0.13, 1.3 * spread]]) * length
            claws.append(tube(points[-1] + reach @ swing.T, [0.55 * radius, 0.5 * radius, 0.2 * radius]))
        limb = fuse(arm, *claws, blend=0.05)
        parts += carried([limb], Frame(np.zeros(3), np.diag([1.0, 1.0, sign])))
    return parts


def _sail(torso: Floats, height: float) -> list[Part]:
    start, end = float(torso[0, 0]), float(torso[-1, 0])
    base = float(torso[:, 1].min()) - 0.05
    share = np.linspace(0, 1, 9)
    arch = zip(
        start + (end - start) * share, base + 0.12 + height * np.sin(np.pi * share) ** 0.7, strict=True
    )
    outline = rounded([(start, base), *arch, (end, base)], 1)
    return [fuse(Plate(outline, Frame(np.zeros(3), np.eye(3)), 0.018, 0.06, 0.05), blend=0.06)]
