"""Dinosaurs: a body plan for bipedal ones, and the armour of some quadrupeds.

Bipedal dinosaurs have a horizontal trunk, a long tail, jaws and small arms, in units of the distance from
hip to chest.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from normalgan.animals.birds import Legs
from normalgan.animals.frames import Frame, about, bend, pitch, spanned, unit, way_along, yaw
from normalgan.animals.parts import Part, ball, carried, fuse, on_side, pair, tube
from normalgan.animals.plan import Eyeball, PosedPlan, Rng, proportions
from normalgan.animals.shapes import Plate, Sweep, rounded
from normalgan.animals.stations import Profile, Spine, Stations
from normalgan.animals.tables import Number, Point, Span, Table
from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.ranges import OneOf, Range

_RANGES: Mapping[str, Span] = {
    "girth": (0.88, 1.15), "tail": (0.85, 1.12), "neck": (0.88, 1.12), "head": (0.88, 1.15),
    "arm": (0.85, 1.2), "legs": (0.9, 1.08), "sail": (0.75, 1.2),
}  # fmt: skip
_YOUNG: Mapping[str, float] = {"head": 1.3, "neck": 0.85, "tail": 0.85, "girth": 0.95, "legs": 1.08}
_YOUNG_PROBABILITY = 0.12
_POSES = ("stand", "walk", "run", "roar")


@dataclass(frozen=True)
class Arm(Table):
    """A pair of arms.

    Args:
        shoulder: position of the right shoulder.
        length: length of an arm.
        radius: radius of an arm.
    """

    shoulder: Point
    length: Number
    radius: Number


@dataclass(frozen=True)
class Theropod(PosedPlan):
    """A kind of bipedal dinosaur with the hip at x = 0.

    Args:
        torso: stations from the root of the tail to the chest.
        tail: stations from the tip into the torso.
        neck: stations from inside the chest to the head.
        length: length of the head.
        skull: stations of head and upper jaw, in units of ``length``.
        jaw: stations of the lower jaw, hinged at the first, in units of ``length``.
        eye: right eye, in units of ``length``.
        arm: arms.
        leg: legs.
        sail: height of a sail on the back, 0 for no sail.
        pitch: upward angle of the trunk in degrees.
        ranges: ranges of proportions that differ from the defaults.

    Raises:
        InputError: if the tail does not begin behind the hip.
    """

    habits: tuple[Annotated[str, OneOf(_POSES)], ...]
    torso: Profile
    tail: Profile
    neck: Stations
    length: Number
    skull: Profile
    jaw: Profile
    eye: Eyeball
    arm: Arm
    leg: Legs
    sail: Number = 0.0
    pitch: Span = (-4.0, 16.0)
    ranges: Mapping[Annotated[str, OneOf(_RANGES)], Span] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the tail."""
        if self.tail.x[0] >= 0:
            raise InputError(f"tail begins behind the hip, at an x less than 0, not at {self.tail.x[0]:g}.")

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        young = _YOUNG if rng.uniform() < _YOUNG_PROBABILITY else None
        build = proportions(_RANGES, self.ranges, rng, young)
        tilt = rng.uniform(*self.pitch) + {"run": -5.0, "roar": 14.0}.get(pose, 0.0)
        whole = about((0, 0, 0), pitch(tilt))
        torso = self.torso.wider(build["girth"])
        tail = replace(self.tail, x=self.tail.x * build["tail"])
        parts = [fuse(torso.sweep().placed(whole)), fuse(_tail(tail, tilt, rng), blend=0.12)]
        points = self.neck.points
        points = whole.place(points[0] + (points - points[0]) * build["neck"])
        aside = float(np.clip(rng.normal(0, 13), -30, 30))
        bent, _ = bend(points, rng.uniform(-8, 8) + (10.0 if pose == "roar" else -0.3 * tilt), aside)
        radii = self.neck.radius * np.linspace(1, build["head"], len(bent))
        parts.append(fuse(tube(bent, radii), blend=0.15))
        nod = rng.uniform(-14, 2) + (16.0 if pose == "roar" else 0.0)
        head = Frame(bent[-1], yaw(1.4 * aside) @ pitch(nod))
        gape = float(rng.uniform(24, 36) if pose == "roar" else rng.choice([4.0, 6.0, 18.0]))
        parts += carried(_head(self, gape), head, self.length * build["head"])
        arms = _arms(self, build["arm"], rng)
        sail = [_sail(torso, self.sail * build["sail"])] if self.sail else []
        parts += carried([*arms, *sail], whole)
        stride = "walk" if pose == "run" else "stand" if pose == "roar" else pose
        return parts + self.leg.grow(build["legs"], stride, whole, rng)


def _tail(rows: Profile, tilt: float, rng: Rng) -> Sweep:
    xs = np.linspace(rows.x[0], 0.0, 17)
    behind = xs / xs[0]
    sway = rng.normal(0, 32) * behind + rng.normal(0, 24) * np.sin(2 * np.pi * behind)
    spine = Spine(xs, sway - sway[-1])
    # The root is rotated with the trunk, and the rest stays horizontal or slightly raised.
    drop = np.tan(np.deg2rad(tilt)) * np.maximum(rows.x, -0.35)
    drop = drop + rng.uniform(-0.1, 0.22) * np.minimum(rows.x + 0.5, 0) ** 2
    sweep = spine.sweep(replace(rows, top=rows.top + drop, bottom=rows.bottom + drop))
    root = spine.frame(0.0).origin
    return replace(sweep, points=sweep.points - root)


def _head(kind: Theropod, gape: float) -> list[Part]:
    """Return the head in its own frame and unit."""
    (x, y, z), radius = kind.eye.at, kind.eye.radius
    skull = kind.skull
    brow = tube([(x - 0.10, y + radius, 0.9 * z), (x + 0.10, y + 0.9 * radius, 0.95 * z)], [0.045, 0.035])
    nose, high, wide = skull.x[-1], skull.top[-1], skull.half_width[-1]
    nostril = tube([(nose + 0.01, high * 0.7, wide * 0.9), (nose - 0.05, high * 0.85, wide)], 0.022)
    return [
        fuse(skull.sweep(), blend=0.20),
        fuse(kind.jaw.opened(gape), blend=0.03),
        pair(brow, blend=0.05),
        pair(ball((x, y, z), radius)),
        pair(nostril, blend=0.01, carve=True),
    ]


def _arms(kind: Theropod, factor: float, rng: Rng) -> list[Part]:
    length, radius = kind.arm.length * factor, kind.arm.radius
    parts = []
    for right in (True, False):
        swing = pitch(rng.normal(0, 14))
        shoulder = np.array(kind.arm.shoulder)
        bones = np.array([[0, 0, 0], [-0.25, -0.42, 0.10], [0.12, -0.60, 0.10], [0.26, -0.66, 0.06]]) * length
        points = shoulder + bones @ swing.T
        arm = tube(points, [1.5 * radius, radius, 0.75 * radius, 0.8 * radius])
        claws = []
        for spread in (-0.09, 0.0, 0.09):
            reach = np.array([[0, 0, 0], [0.16, -0.02, spread], [0.26, -0.13, 1.3 * spread]]) * length
            claws.append(tube(points[-1] + reach @ swing.T, [0.55 * radius, 0.5 * radius, 0.2 * radius]))
        parts.append(fuse(*(on_side(one, right) for one in (arm, *claws)), blend=0.05))
    return parts


def _sail(torso: Profile, height: float) -> Part:
    start, end = float(torso.x[0]), float(torso.x[-1])
    base = float(torso.top.min()) - 0.05
    fraction = np.linspace(0, 1, 9)
    heights = base + 0.12 + height * np.sin(np.pi * fraction) ** 0.7
    arch = np.column_stack([start + (end - start) * fraction, heights])
    outline = rounded([(start, base), *arch, (end, base)], 1)
    return fuse(Plate(Frame(np.zeros(3), np.eye(3)), outline, 0.018, 0.06, 0.05), blend=0.06)


# Outline of a plate on the back: along the back, upwards.
_LEAF = ((-0.42, -0.15), (-0.50, 0.30), (-0.26, 0.72), (0.02, 1.0), (0.26, 0.70), (0.50, 0.28), (0.40, -0.15))


@dataclass(frozen=True)
class Armour(Table):
    """Spines or plates along the back of some dinosaurs.

    Args:
        plates: number of plates, in two rows.
        height: height of the largest plate, in units of the height at the withers.
        spikes: number of pairs of spikes near the tip of the tail.
        frill: extent of a shield behind the head, in head lengths; 0 for no shield.
    """

    plates: Annotated[int, Range(0, 100)] = 0
    height: Number = 0.0
    spikes: Annotated[int, Range(0, 8)] = 0
    frill: Number = 0.0

    def grow(self, neck: Sweep, skull: Sweep, torso: Sweep, tail: Sweep, rng: Rng) -> list[Part]:
        """Return the parts of the armour on a body."""
        parts = []
        size = self.height * rng.uniform(0.85, 1.2)
        if self.plates:
            parts += _rows(_back(neck, torso, tail), self.plates, size)
        if self.spikes:
            parts.append(fuse(*_spikes(tail, self.spikes, size), blend=0.03))
        if self.frill:
            parts.append(fuse(_frill(skull, self.frill * rng.uniform(0.85, 1.15)), blend=0.06))
        return parts


def _back(neck: Sweep, torso: Sweep, tail: Sweep) -> Doubles:
    """Return the line of the back from behind the head to the tip of the tail, (n, 3)."""
    fine = [each.smoothed(8) for each in (neck, torso, tail)]
    tops = [each.points + np.outer(each.radii, [0.0, 1.0, 0.0]) for each in fine]
    ahead = tops[0][tops[0][:, 0] > tops[1][-1, 0]][::-1]
    behind = tops[2][tops[2][:, 0] < tops[1][0, 0]]
    return np.vstack([ahead, tops[1][::-1], behind])


def _rows(line: Doubles, count: int, size: float) -> list[Part]:
    plates = []
    for i in range(count):
        t = (i + 0.6) / count
        tall = size * (0.30 + 0.70 * np.sin(np.pi * (0.06 + 0.88 * t)) ** 1.1)
        plates.append(_plate(line, 0.02 + 0.78 * t, tall, 1.0 if i % 2 else -1.0))
    # Each row is a separate part, because neighbouring plates would otherwise blend.
    return [fuse(*plates[0::2], blend=0.03), fuse(*plates[1::2], blend=0.03)]


def _plate(line: Doubles, fraction: float, tall: float, side: float) -> Plate:
    steps = way_along(line)
    before, at, after = (
        np.array([np.interp(fraction * steps[-1] + far, steps, column) for column in line.T])
        for far in (-0.12, 0.0, 0.12)
    )
    ahead = unit(before - after)
    frame = spanned(at + np.array([0.0, 0.0, 0.035 * side]), ahead, np.array([0.0, 1.0, 0.30 * side]))
    return Plate(frame, rounded(_LEAF, 1) * tall * [0.92, 1.0], 0.012, 0.12, 0.035)


def _spikes(tail: Sweep, pairs: int, size: float) -> list[Sweep]:
    fine = tail.smoothed(8)
    spikes: list[Sweep] = []
    for i in range(pairs):
        at = len(fine.points) - 3 - 4 * i
        root = fine.points[at]
        for sign in (1.0, -1.0):
            tip = root + size * 0.75 * np.array([-0.45, 0.55, 0.75 * sign])
            spikes.append(tube([root, (root + tip) / 2, tip], [0.032, 0.026, 0.010]))
    return spikes


def _frill(skull: Sweep, reach: float) -> Plate:
    """Return the scalloped shield behind the head, concave towards the front."""
    nose = skull.points[-1] - skull.points[0]
    length = float(np.linalg.norm(nose))
    ahead, right = nose / length, skull.sides[0]
    up = np.cross(right, ahead)
    tall = -0.62 * ahead + 0.78 * up
    across = np.cross(tall, right)
    rim = []
    for i, angle in enumerate(np.deg2rad(np.linspace(-28, 208, 27))):
        far = reach * length * (1.0 if i % 2 else 0.93)
        rim.append((0.86 * far * float(np.cos(angle)), far * (0.20 + 0.80 * float(np.sin(angle)))))
    origin = skull.points[0] + length * (0.12 * ahead + 0.06 * up)
    frame = Frame(origin, np.column_stack([right, tall, across]))
    return Plate(frame, rounded(rim, 1), 0.03, 0.10, 0.05, bow=(0.5 / length, 0.0))
