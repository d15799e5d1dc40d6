"""Reptiles: lizards and crocodiles, turtles, snakes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from normalgan.animals.frames import Frame, about, bend, pitch, spanned, way_along, yaw
from normalgan.animals.parts import Part, ball, by, carried, fuse, in_space, on_side, pair, tube
from normalgan.animals.plan import Eyeball, PosedPlan, Rng, around, proportions
from normalgan.animals.shapes import Plate, Sweep, rounded
from normalgan.animals.stations import Profile, Spine
from normalgan.animals.tables import Number, Point, Span
from normalgan.arrays import Doubles
from normalgan.ranges import OneOf, Range

_RANGES: Mapping[str, Span] = {
    "girth": (0.88, 1.18), "tail": (0.8, 1.15), "head": (0.9, 1.18), "legs": (0.88, 1.15),
    "crest": (0.7, 1.3),
}  # fmt: skip
_CRAWLING = ("crawl", "stand", "bask", "gape")
_SHELLED = ("stand", "walk", "hide", "swim", "glide")
_COILED = ("coil", "wind", "rear")


@dataclass(frozen=True)
class Crawler(PosedPlan):
    """A kind of lizard or crocodile: a long trunk bent sideways, sprawling legs, belly near y = 0.

    Lengths are in units of the distance from the snout to the root of the tail.

    Args:
        trunk: stations from the tip of the tail, at x < 0, to the neck; the tail starts at x = 0.
        head: length of the head.
        skull: stations of the head with its upper jaw, in its own frame, in units of ``head``.
        jaw: stations of the lower jaw, hinged at the first.
        neck: (x, y) where the head is attached.
        eye: right eye, in units of ``head``.
        shoulder: position of the right shoulder.
        hip: position of the right hip.
        reach: length of a leg.
        thick: radius of a leg.
        crest: height of spikes along the back, 0 for no spikes.
        scutes: number of pairs of rows of bumps on the back.
        ranges: ranges of proportions that differ from the defaults.
    """

    habits: tuple[Annotated[str, OneOf(_CRAWLING)], ...]
    trunk: Profile
    head: Number
    skull: Profile
    jaw: Profile
    neck: tuple[Number, Number]
    eye: Eyeball
    shoulder: Point
    hip: Point
    reach: Number
    thick: Number
    crest: Number = 0.0
    scutes: Annotated[int, Range(0, 10)] = 0
    ranges: Mapping[Annotated[str, OneOf(_RANGES)], Span] = field(default_factory=dict)

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        build = proportions(_RANGES, self.ranges, rng)
        x = self.trunk.x
        rows = replace(self.trunk, x=np.where(x < 0, x * build["tail"], x)).wider(build["girth"])
        spine = _crawler_spine(rows, pose, rng)
        parts = [fuse(spine.sweep(rows))]
        at = spine.frame(self.neck[0])
        lift = rng.uniform(0, 10) + (8.0 if pose == "gape" else 0.0)
        turn = float(np.clip(rng.normal(0, 14), -30, 30))
        head = Frame(at.place([0.0, self.neck[1], 0.0]), at.rotation @ yaw(turn) @ pitch(lift))
        gape = rng.uniform(20, 32) if pose == "gape" else rng.uniform(1, 4)
        parts += carried(_crawler_head(self, gape), head, self.head * build["head"])
        for root, ahead in ((self.shoulder, 1), (self.hip, -1)):
            for sign in (1.0, -1.0):
                swing = rng.normal(0, 6)
                if pose == "crawl":  # diagonal legs go together
                    swing += 26.0 * sign * ahead * rng.uniform(0.6, 1.0)
                leg = _crawler_leg(root, self.reach * build["legs"], self.thick, ahead, swing)
                sided = fuse(*(on_side(one, sign > 0) for one in leg), blend=0.05)
                parts.append(sided.placed(spine.frame(root[0])))
        if self.crest:
            parts.append(fuse(*_crest(rows, self.crest * build["crest"], spine), blend=0.015))
        if self.scutes:
            parts.append(fuse(*_bumps(rows, self.scutes, spine), blend=0.012))
        return parts


@dataclass(frozen=True)
class Turtle(PosedPlan):
    """A kind of turtle with a shell of length 1.

    Args:
        dome: height of the shell above its rim.
        half_width: half of the shell's width.
        neck: length of the neck.
        skull: stations of the skull, or the name of a shared skull.
        clear: height of the rim above the ground.
        flippers: whether it swims with flippers instead of walking.
        bumpy: height of the bulges on the scutes.
    """

    habits: tuple[Annotated[str, OneOf(_SHELLED)], ...]
    dome: Number
    half_width: Number
    neck: Number
    skull: Profile
    clear: Number = 0.0
    flippers: bool = False
    bumpy: Number = 0.02

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        dome, half_width, clear, neck, size, limbs = around(
            rng, 0.12, self.dome, self.half_width, self.clear, self.neck, 1.0, 1.0
        )
        radii = np.array([0.50, dome, half_width])
        rim = 0.0 if self.flippers else clear
        under = 0.28 if self.flippers else 0.34
        shell = [
            fuse(ball((0, rim), radii)),
            # Only the dome: everything below its rim is cut off and replaced by a flatter belly.
            fuse(_slab(rim, radii), carve=True, blend=0.02),
            fuse(ball((0, rim + 0.005), (0.525, 0.045, 1.05 * radii[2])), blend=0.05),
            fuse(ball((0, rim), (0.46, under * radii[1], 0.88 * radii[2])), blend=0.04),
            *([fuse(*_scutes(radii, rim, self.bumpy), blend=0.25 * radii[1])] if self.bumpy else []),
            fuse(*_grooves(radii, rim), carve=True, blend=0.008),
        ]
        tail = tube([(-0.40, rim), (-0.52, rim - 0.03), (-0.62, rim - 0.07)], [0.06, 0.04, 0.012])
        parts = [*shell, fuse(tail, blend=0.03)]
        out = neck * (0.35 if pose == "hide" else 1.0)
        stretch = in_space([(0.36, rim - 0.01), (0.48, rim + 0.01), (0.50 + out, rim + 0.10 * (out > 0.1))])
        aside = float(np.clip(rng.normal(0, 16), -35, 35))
        bent, _ = bend(stretch, rng.uniform(-10, 22), aside)
        parts.append(fuse(tube(bent, [0.11, 0.085, 0.07]), blend=0.05))
        head = Frame(bent[-1], yaw(aside) @ pitch(rng.uniform(-12, 14)))
        beak = tube([(0.15, 0.0), (0.20, -0.02), (0.205, -0.06)], [0.05, 0.035, 0.012])
        mouth = tube([(0.06, -0.045, 0.092), (0.13, -0.045, 0.066), (0.18, -0.05, 0.028)], 0.007)
        face = [
            fuse(self.skull.sweep(), blend=0.03),
            fuse(beak, blend=0.02),
            pair(ball((0.085, 0.045, 0.074), 0.021)),
            pair(mouth, carve=True, blend=0.004),
        ]
        parts += carried(face, head, 1.15 * size)
        return parts + (_flippers if self.flippers else _turtle_legs)(radii, rim, limbs, pose, rng)


@dataclass(frozen=True)
class Snake(PosedPlan):
    """A kind of snake: a long tapering tube, coiled, winding or raised.

    Args:
        skull: stations of the skull, or the name of a shared skull.
        hooded: whether the neck is spread, like a cobra's.
    """

    habits: tuple[Annotated[str, OneOf(_COILED)], ...]
    skull: Profile
    hooded: bool = False

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        fat = rng.uniform(0.060, 0.085)
        line = {"coil": _coil, "wind": _wind, "rear": _rear}[pose](fat, rng)
        steps = way_along(line)
        fraction = steps / steps[-1]  # 0 at the tip of the tail, 1 at the head
        radii = fat * np.interp(fraction, [0, 0.18, 0.5, 0.85, 1.0], [0.16, 0.62, 1.0, 0.92, 0.62])
        line[:, 1] += radii - fat  # each part lies on the ground or on the coil below
        way = line[-1] - line[-2]
        heading = float(np.rad2deg(np.arctan2(-way[2], way[0])))
        level = rng.uniform(-18, 4) - (8.0 if self.hooded else 0.0)
        head = Frame(line[-1], yaw(heading) @ pitch(level))
        parts = [fuse(tube(line, radii))]
        if self.hooded and pose == "rear":
            parts.append(fuse(_hood(line, fat, yaw(heading)[:, 2], rng), blend=0.03))
        eyes = ball((0.36, 0.20, 0.37), 0.115)
        lips = [(-0.05, -0.08, 0.53), (0.35, -0.10, 0.46), (0.75, -0.08, 0.30), (1.02, -0.08, 0.12)]
        pits = tube([(0.95, 0.02, 0.14), (0.85, 0.05, 0.18)], 0.045)
        face = [
            fuse(self.skull.sweep(), blend=0.4),
            pair(eyes),
            pair(tube(lips, 0.035), pits, carve=True, blend=0.02),
        ]
        return parts + carried(face, head, 1.75 * fat * rng.uniform(0.9, 1.2))


def _crawler_spine(rows: Profile, pose: str, rng: Rng) -> Spine:
    xs = np.linspace(rows.x[0], rows.x[-1] + 0.05, 41)
    fraction = (xs[-1] - xs) / (xs[-1] - xs[0])
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    if pose == "crawl":
        turns = side * (14 + 34 * fraction) * np.sin(2 * np.pi * (1.15 * fraction + rng.uniform(-0.08, 0.08)))
    elif pose == "bask":  # curled to one side, most strongly at the tail
        turns = side * rng.uniform(90, 165) * fraction**1.8
    else:
        turns = side * rng.uniform(0, 40) * fraction**1.3 + rng.normal(0, 10) * np.sin(5 * fraction)
    return Spine(xs, turns - turns[-1])


def _crawler_head(kind: Crawler, gape: float) -> list[Part]:
    skull = kind.skull
    x, y, z = skull.x[-1], skull.top[-1], skull.half_width[-1]
    nostril = tube([(x, y, 0.55 * z), (x - 0.05, y + 0.015, 0.6 * z)], 0.022)
    return [
        fuse(skull.sweep(), blend=0.18),
        fuse(kind.jaw.opened(gape), blend=0.02),
        pair(ball(kind.eye.at, kind.eye.radius), blend=0.03),
        pair(nostril, blend=0.01, carve=True),
    ]


def _crawler_leg(root: Point, reach: float, thick: float, ahead: int, swing: float) -> list[Sweep]:
    """Return a right leg: outwards from the flank, down from elbow or knee, with the foot flat on the ground.

    Elbows point backwards and knees forward: ``ahead`` is 1 for a foreleg and -1 for a hind leg.
    """
    _, y, z = root
    ground = -thick * 0.4
    elbow = [0.22 * -ahead * reach, y + 0.10 * reach, z + 0.44 * reach]
    foot = [0.06 * reach, ground + 0.5 * thick, z + 0.66 * reach]
    joint, foot = about((0.0, 0.0, z), yaw(swing)).place([elbow, foot])
    bones = [(0, y, 0.7 * z), (0, y, z), joint, foot]
    parts = [tube(bones, np.array([1.35, 1.3, 0.95, 0.72]) * thick)]
    for spread in (-58.0, -28.0, 0.0, 26.0, 52.0):
        length = (0.30 if abs(spread) < 40 else 0.22) * reach
        way = yaw(swing - 38.0 + spread) @ np.array([length, 0.0, 0.0])
        tip = foot + way
        middle = foot + 0.55 * way + [0.0, 0.25 * thick, 0.0]
        tip[1], middle[1] = ground + 0.1 * thick, max(middle[1], ground + 0.4 * thick)
        parts.append(tube([foot, middle, tip], [0.55 * thick, 0.42 * thick, 0.22 * thick]))
    return parts


def _crest(rows: Profile, height: float, spine: Spine) -> list[Sweep]:
    spikes, tail = [], rows.x[0]
    for x in np.arange(rows.x[-1] - 0.02, 0.45 * tail, -0.055):
        top = rows.at(x)[0]
        tall = height * float(np.interp(x, [0.4 * tail, 0.0, 0.7], [0.3, 0.7, 1.0]))
        points = [(x + 0.02, top - 0.02), (x - 0.03, top + tall)]
        spikes.append(tube(spine.place(points), [0.030, 0.010], [0.014, 0.008]))
    return spikes


def _bumps(rows: Profile, pairs: int, spine: Spine) -> list[Sweep]:
    """Return the scutes of a crocodile's back."""
    bumps = []
    for x in np.arange(rows.x[-1] - 0.02, 0.8 * rows.x[0], -0.062):
        top, bottom, wide = rows.at(x)
        tail = x < 0.45 * rows.x[0]  # the two inner rows merge on the tail
        for k in range(1 if tail else pairs):
            fraction = 0.0 if tail else (0.24 + 0.46 * k / max(pairs - 1, 1))
            y = (top + bottom) / 2 + (top - bottom) / 2 * np.sqrt(1 - fraction**2)
            for sign in (1.0,) if tail else (1.0, -1.0):
                z = sign * fraction * wide
                points = [[x + 0.018, y - 0.006, z], [x - 0.018, y + (0.028 if tail else 0.012), z]]
                bumps.append(tube(spine.place(points), [0.020, 0.012], [0.015, 0.010]))
    return bumps


# Corners between scutes of the middle row and the flanks: x and z, as fractions of half length and half
# width.
_CORNERS = [(-0.86, 0.16), (-0.62, 0.34), (-0.42, 0.24), (-0.22, 0.36), (-0.01, 0.25), (0.20, 0.36),
            (0.40, 0.24), (0.58, 0.32), (0.82, 0.14)]  # fmt: skip


def _slab(rim: float, radii: Doubles) -> Sweep:
    """Return the volume below the rim of the dome, to be subtracted."""
    deep = float(radii[1]) + 0.1
    points = [(-0.8, rim - deep - 0.01), (0.8, rim - deep - 0.01)]
    return tube(points, deep, 8.0)


def _on(radii: Doubles, rim: float, x: float, z: float, out: float = 0.0) -> Doubles:
    """Return the point on the dome above (x, z), given as fractions of half its length and half its width."""
    y = np.sqrt(max(1 - x * x - z * z, 0.0))
    point: Doubles = np.array([0.0, rim, 0.0]) + radii * np.array([x, y, z]) * (1 + out)
    return point


def _scutes(radii: Doubles, rim: float, bumpy: float) -> list[Sweep]:
    """Return the bulges in the middle of the scutes."""
    middles = [(x, 0.0) for x, _ in _CORNERS[1::2]]
    middles += [(x, z) for x in (-0.50, -0.02, 0.44) for z in (0.56, -0.56)]
    bulges = []
    for x, z in middles:
        inner, outer = _on(radii, rim, x, z, -0.10), _on(radii, rim, x, z, bumpy - 0.14)
        bulges.append(tube([inner, outer], [0.14, 0.07]))
    return bulges


def _grooves(radii: Doubles, rim: float) -> list[Sweep]:
    """Return the lines between the scutes: a middle row of hexagons between two rows along the flanks."""
    lines = []
    for sign in (1, -1):
        lines.append([_on(radii, rim, x, sign * w) for x, w in _CORNERS])
        for x, w in _CORNERS[1::2]:
            far = 0.93 * np.sqrt(1 - x * x)
            lines.append([_on(radii, rim, x * 1.02, sign * z) for z in np.linspace(w, far, 5)])
    for x, w in _CORNERS[2:-1:2]:
        lines.append([_on(radii, rim, x, z) for z in np.linspace(-w, w, 5)])
    return [tube(line, 0.010) for line in lines]


def _turtle_legs(radii: Doubles, rim: float, factor: float, pose: str, rng: Rng) -> list[Part]:
    legs, toes = [], []
    for x, fore in ((0.30, True), (-0.32, False)):
        for sign in (1.0, -1.0):
            step = rng.uniform(0.06, 0.12) * sign * (1 if fore else -1) if pose == "walk" else 0.0
            z = sign * radii[2] * 0.66
            foot = np.array([x + step + (0.07 if fore else -0.05), 0.06, 1.16 * z])
            knee = np.array([x + 0.5 * step + (0.05 if fore else -0.06), 0.5 * rim + 0.04, 1.14 * z])
            hip = np.array([x, rim, z * 0.8])
            legs.append(tube([hip, knee, foot], [0.12, 0.10 * factor, 0.085 * factor]))
            for spread in (-0.05, 0.0, 0.05):
                tip = by(foot, 0.085, -0.035, spread)
                toes.append(tube([by(foot, 0.04, -0.03, spread), tip], [0.035, 0.022]))
    return [fuse(*legs, blend=0.03), fuse(*toes, blend=0.03)]


# Outlines of right flippers: outwards, forward.
_FORE_FLIPPER = [(0.0, 0.08), (0.20, 0.11), (0.42, 0.0), (0.66, -0.24), (0.68, -0.30), (0.44, -0.20),
                 (0.16, -0.09), (0.0, -0.08)]  # fmt: skip
_HIND_FLIPPER = [(0.0, 0.06), (0.16, 0.05), (0.28, -0.06), (0.26, -0.12), (0.12, -0.10), (0.0, -0.06)]


def _flippers(radii: Doubles, rim: float, factor: float, pose: str, rng: Rng) -> list[Part]:
    parts = []
    lift = rng.uniform(-28, 34) if pose == "swim" else rng.uniform(-8, 6)
    for corners, x, sweep, up in (
        (_FORE_FLIPPER, 0.30, 8.0, lift),
        (_HIND_FLIPPER, -0.36, 52.0, -0.4 * lift),
    ):
        out, rise = np.deg2rad(sweep), np.deg2rad(up)
        first = np.array([-np.sin(out) * np.cos(rise), np.sin(rise), np.cos(out) * np.cos(rise)])
        frame = spanned(np.array([x, rim - 0.02, 0.74 * radii[2]]), first, np.array([1.0, 0.0, 0.0]))
        parts.append(pair(Plate(frame, rounded(corners) * factor, 0.016, 0.25, 0.05), blend=0.05))
    return parts


def _spiral(fat: float, turns: float, inner: float, rise: float, end: float, rng: Rng) -> Doubles:
    """Return a flat coil from the tip of the tail on the outside inwards.

    Args:
        fat: radius of the snake.
        turns: number of turns.
        inner: inner radius of the coil.
        rise: rise of each turn above the next outer turn, in units of ``fat``.
        end: final angle in radians.
        rng: source of randomness for the direction of the coil.
    """
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    angle = np.linspace(0, 2 * np.pi * turns, int(14 * turns))
    radius = inner + 1.9 * fat * (angle[-1] - angle) / (2 * np.pi)
    phase = angle + (-angle[-1] + end)
    height = fat + rise * fat * angle / (2 * np.pi)
    return np.column_stack([radius * np.cos(phase), height, side * radius * np.sin(phase)])


def _with_neck(spiral: Doubles, neck: list[tuple[float, float]], tall: float) -> Doubles:
    """Return a coil continued by a neck in the middle plane, with points (x, fraction of ``tall``)."""
    end = spiral[-1]
    raised = end[:2] + np.array(neck) * [1.0, tall]
    return np.vstack([spiral, np.column_stack([raised, np.linspace(end[2], 0.0, len(neck) + 1)[1:]])])


def _coil(fat: float, rng: Rng) -> Doubles:
    """Return a coil with the head raised in the middle."""
    spiral = _spiral(fat, rng.uniform(2.2, 3.0), 0.16, 0.75, -np.pi / 2, rng)
    neck = [(0.12, 0.05), (0.16, 0.45), (0.04, 0.9), (0.10, 1.15), (0.26, 1.18)]
    return _with_neck(spiral, neck, rng.uniform(0.10, 0.30) + 0.08)


def _wind(fat: float, rng: Rng) -> Doubles:
    """Return a line that winds over the ground, with the head slightly raised."""
    x = np.linspace(-1.0, 0.72, 40)
    waves, size = rng.uniform(1.4, 2.3), rng.uniform(0.16, 0.26)
    grow = np.clip((0.80 - x) / 0.45, 0, 1)
    z = size * grow * np.sin(waves * np.pi * (x + 1.0) + rng.uniform(0, 2 * np.pi))
    y = fat + rng.uniform(0.0, 0.14) * np.clip((x - 0.45) / 0.27, 0, 1) ** 1.5
    return np.column_stack([x, y, z])


def _rear(fat: float, rng: Rng) -> Doubles:
    """Return a coil with its front third raised."""
    spiral = _spiral(fat, rng.uniform(1.3, 1.9), 0.20, 0.5, -0.75 * np.pi, rng)
    neck = [(0.15, 0.06), (0.20, 0.26), (0.14, 0.52), (0.10, 0.78), (0.13, 0.94), (0.24, 1.0)]
    return _with_neck(spiral, neck, rng.uniform(0.55, 0.85))


def _hood(line: Doubles, fat: float, side: Doubles, rng: Rng) -> Sweep:
    """Return the spread neck of a cobra."""
    upper = line[-5:]
    wide = fat * rng.uniform(2.2, 2.9) * np.array([0.35, 0.72, 1.0, 0.80, 0.35])
    return tube(upper, np.array([0.8, 0.62, 0.5, 0.5, 0.5]) * fat, wide, side)
