"""What a kind of bird is, in units of the length of its body, and how its parts come together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from normalgan.animals.bird_legs import LegShape, legs
from normalgan.animals.bird_wings import Wing, folded, opened, tail_fan
from normalgan.animals.chain import Frame, bend, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, carried, fuse, moved, tube
from normalgan.animals.plan import Form, Rng
from normalgan.animals.shapes import Rows, trunk
from normalgan.animals.sweep import Floats, Sweep

Range = tuple[float, float]
Extra = Callable[[Rng, float], list[Part]]
YOUNG_SHARE = 0.15


@dataclass(frozen=True)
class Bird:
    """A kind of bird.

    Args:
        body: stations (x, top, bottom, half width) from the rump, x = 0, to the breast, x = 1, lying flat.
        pitch: degrees by which the breast is raised when it stands.
        neck: stations (x, y, radius) from inside the breast to the head, in the upright bird, as
            differences from the first.
        low: the same stations when it feeds.
        head: stations (x, top, bottom, half width) of the skull in its own frame, in units of ``skull``.
        skull: size of the head.
        eye: (x, y, z, radius) in the skull's frame and unit.
        beak: stations (x, y, radius, half width) of the upper half, in the skull's frame and unit.
        jaw: those of the lower half.
        wing: the wings.
        tail: (length, feathers, half width of a feather, degrees of the closed fan, degrees it is raised).
        leg: the legs.
        poses: the poses it is drawn in.
        face: crests, combs, tufts, in the skull's frame and unit.
        train: sickle feathers and the like, in the body's frame.
        turn: greatest turn of the head.
        chick: whether it is drawn young at times.
        plump: ranges of proportions that differ from the general ones.
    """

    body: Rows
    pitch: Range
    neck: Rows
    low: Rows
    head: Rows
    skull: float
    eye: tuple[float, float, float, float]
    beak: Rows
    jaw: Rows
    wing: Wing
    tail: tuple[float, int, float, float, float]
    leg: LegShape
    poses: tuple[str, ...]
    face: Extra | None = None
    train: Extra | None = None
    turn: float = 35.0
    chick: bool = False
    ranges: Mapping[str, Range] = field(default_factory=dict)


RANGES: Mapping[str, Range] = {
    "girth": (0.88, 1.15), "neck": (0.9, 1.12), "head": (0.92, 1.12), "beak": (0.85, 1.18),
    "tail": (0.8, 1.2), "legs": (0.88, 1.12), "wing": (0.9, 1.12),
}  # fmt: skip
CHICK: Mapping[str, float] = {
    "girth": 1.0, "neck": 1.05, "head": 1.3, "beak": 0.7, "tail": 0.4, "legs": 0.85, "wing": 0.6,
}  # fmt: skip


def bird(kind: Bird) -> Form:
    """Return the body plan of a kind of bird."""
    return Form(kind.poses, lambda pose, rng: assemble(kind, pose, rng))


def assemble(kind: Bird, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one bird, in the order in which they blend."""
    young = kind.chick and pose in {"stand", "walk", "swim"} and bool(rng.uniform() < YOUNG_SHARE)
    build = {name: float(rng.uniform(*kind.ranges.get(name, RANGES[name]))) for name in RANGES}
    build = {name: value * (CHICK[name] if young else 1.0) for name, value in build.items()}
    tilt = float(rng.uniform(*kind.pitch))
    tilt = {"soar": 4.0, "swim": 0.6 * tilt, "feed": 0.35 * tilt - 8.0}.get(pose, tilt)
    turn = pitch(tilt)
    middle = turn @ np.array([0.5, 0.0, 0.0])
    body = Frame(-middle, turn)  # the middle of the body at the origin; the legs find the ground

    rows = np.array(kind.body)
    rows[:, 3] *= build["girth"]
    rows[:, 2] *= 0.5 + 0.5 * build["girth"]
    down = (0.004, 0.06) if young else None
    parts = [fuse(moved(trunk(rows), body), ripple=down)]
    neck, head = _neck(kind, pose, build, body, rng)
    parts.append(Part(neck.sweeps, neck.blend, ripple=down))
    parts += _head(kind, build, head, rng, young)
    out = pose in {"soar", "spread", "land"}
    length, feathers, half = kind.tail[:3]
    open_fan = float(np.rad2deg(2.2 * half * (feathers - 1) / (length + 0.16)))  # their ends just touch
    spread = min({"soar": 40.0, "spread": 46.0, "land": 60.0}[pose], open_fan) if out else kind.tail[3]
    fan = tail_fan(kind.tail, build["tail"], spread * float(rng.uniform(0.8, 1.2)), float(rng.normal(0, 5)))
    parts += carried(fan, body)
    if kind.train is not None and not young:
        parts += carried(kind.train(rng, build["tail"]), body)
    if out:
        parts += carried(opened(kind.wing, rows, build["wing"], pose, tilt, rng), body)
    else:
        parts += carried(folded(kind.wing, rows, build["wing"], young), body)
    if pose != "swim":
        parts += legs(kind.leg, build["legs"], pose, body, rng)
    return parts


def _neck(kind: Bird, pose: str, build: Mapping[str, float], body: Frame, rng: Rng) -> tuple[Part, Frame]:
    share = float(rng.uniform(0.85, 1.0)) if pose == "feed" else float(rng.uniform(0.0, 0.22))
    up, low = np.array(kind.neck), np.array(kind.low)
    rows = up + share * (low - up)
    if pose == "soar":  # stretched ahead, or drawn in as a heron does
        rows[:, 1] *= 0.25
        rows[:, 0] += 0.5 * np.abs(up[:, 1])
    points = np.column_stack([rows[:, :2] * build["neck"], np.zeros(len(rows))])
    points += body.place(np.array([[0.86, 0.02, 0.0]]))[0]
    aside = float(np.clip(rng.normal(0, 0.35), -1, 1)) * kind.turn
    bent, _ = bend(points, 0.0, 0.4 * aside)
    grow = np.linspace(1.0, build["head"], len(rows))
    sweep = tube(bent, list(rows[:, 2] * grow))
    nod = float(rng.uniform(-8, 10)) - (38.0 * share if pose == "feed" else 0.0)
    return fuse(sweep, blend=0.14), Frame(bent[-1], yaw(aside) @ pitch(nod))


def _head(kind: Bird, build: Mapping[str, float], frame: Frame, rng: Rng, young: bool) -> list[Part]:
    size = kind.skull * build["head"]
    x, y, z, radius = kind.eye
    parts = [
        fuse(trunk(kind.head), blend=0.35),
        fuse(_beak(kind.beak, build["beak"]), blend=0.06),
        fuse(_beak(kind.jaw, build["beak"]), blend=0.02),
        fuse(*both(ball((x, y, z), radius * (1.2 if young else 1.0)))),
    ]
    if kind.face is not None and not young:
        parts += kind.face(rng, 1.0)
    return carried(parts, frame, size)


def _beak(rows: Rows, length: float) -> Sweep:
    stations: Floats = np.array(rows)
    stations[:, 0] = stations[0, 0] + (stations[:, 0] - stations[0, 0]) * length
    points = np.column_stack([stations[:, :2], np.zeros(len(stations))])
    return tube(points, list(stations[:, 2]), list(stations[:, 3]))
