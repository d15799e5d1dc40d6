"""Birds: proportions of a species with its wings, tail and legs, in body lengths.

Feathers are flat sweeps that overlap like roof tiles. A leg has a feathered thigh, a thin shank, three
toes in front and one behind, optionally webbed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal

import numpy as np

from normalgan.animals.frames import Frame, about, bend, hinge, pitch, roll, yaw
from normalgan.animals.parts import Part, Ripple, ball, both, by, carried, fuse, in_space, pair, tube
from normalgan.animals.plan import Eyeball, PosedPlan, Rng, proportions
from normalgan.animals.shapes import Plate, Shape, Sweep, rounded
from normalgan.animals.stations import Profile, Stations
from normalgan.animals.tables import Bone, Number, Point, Span, Table
from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.ranges import OneOf, Range

_STEP = 0.010  # height of a feather above its neighbour
_THIN = 0.012  # half thickness of a feather
_TOES = (-34.0, 0.0, 34.0, 180.0)


@dataclass(frozen=True)
class Wing(Table):
    """A pair of wings, in body lengths.

    Args:
        span: length of one open wing.
        chord: length of the inner flight feathers.
        primaries: number of feathers on the hand.
        width: half width of a feather, relative to the distance between feathers; narrow feathers spread
            like fingers.
        pointed: shape of the tip, from 0 (broad) to 1 (pointed).
        folded: distance by which the folded wing's tip extends beyond the rump.
        depth: half height of the folded wing.
        high: position of the folded wing on the flank, from -1 (belly) to 1 (back).
    """

    span: Number
    chord: Number
    primaries: Annotated[int, Range(2, 30)] = 9
    width: Number = 0.85
    pointed: Number = 0.4
    folded: Number = 0.3
    depth: Number = 0.17
    high: Number = 0.15


@dataclass(frozen=True)
class Tail(Table):
    """A fan of feathers, in body lengths.

    Args:
        length: length of the feathers.
        feathers: number of feathers, at least 2.
        half_width: half width of a feather.
        closed: angle of the closed fan in degrees.
        raised: upward angle of the tail in degrees.
    """

    length: Number
    feathers: Annotated[int, Range(2, 30)]
    half_width: Number
    closed: Number
    raised: Number


@dataclass(frozen=True)
class Legs(Table):
    """A pair of legs, in body lengths.

    Args:
        hip: (x, y, z) of the right hip in the body's frame.
        thigh: length from hip to heel.
        shank: length from heel to toes.
        thick: radius of the shank.
        meat: radius of the thigh at the hip.
        toe: length of the middle toe.
        web: whether the toes are webbed.
        stance: height of the hip when standing, as a fraction of the stretched leg.
        claws: radius at the end of a toe, as a fraction of ``thick``.
    """

    hip: Point
    thigh: Bone
    shank: Bone
    thick: Number
    meat: Number
    toe: Number
    web: bool = False
    stance: Number = 0.88
    claws: Number = 0.5

    def grow(self, factor: float, pose: str, body: Frame, rng: Rng) -> list[Part]:
        """Return both legs in the world; standing legs reach the ground.

        Args:
            factor: factor of the legs' length.
            pose: one of stand, walk, feed, perch, one_leg, soar, spread and land.
            body: frame of the body.
            rng: source of randomness for the stride.
        """
        thigh, shank = self.thigh * factor, self.shank * factor
        stretched = thigh + shank
        x, y, z = self.hip
        middle = body.place([x, y, 0.0])
        high = stretched * (0.62 * self.stance if pose == "perch" else self.stance)
        stride = {"walk": 0.34, "feed": 0.1, "land": 0.06}.get(pose, 0.05) * stretched * rng.uniform(0.6, 1.1)
        side = 1.0 if rng.uniform() < 0.5 else -1.0
        meat: list[Sweep] = []
        feet: list[Part] = []
        for sign in (1.0, -1.0):
            hip = body.place([x, y, sign * z])
            ground = np.array([middle[0] * 0.5 + sign * side * stride, middle[1] - high, sign * z * 0.9])
            foot, flat = _foot(pose, hip, ground, (thigh, shank), sign, lifted=sign == side)
            heading = 6.0 * sign
            heel = hinge(hip, foot, thigh, shank, (-1.0, -0.25, 0.0))
            knee = hip + 0.5 * (heel - hip) + np.array([0.12 * thigh, 0.0, 0.0])
            thigh_tube = tube([hip, knee, heel], [self.meat, 0.62 * self.meat, 1.15 * self.thick],
                              [0.8 * self.meat, 0.55 * self.meat, 1.15 * self.thick])  # fmt: skip
            meat.append(thigh_tube.smoothed(3))  # otherwise its kinks would show as rings
            bone = tube([heel, foot], [1.05 * self.thick, 0.95 * self.thick])
            feet.append(fuse(bone, *_toes(self, foot, heading, flat, rng), blend=0.01))
            if self.web:
                feet.append(fuse(_web(self, foot, heading, flat), blend=0.01))
        return [fuse(*meat, blend=0.07), *feet]


def _foot(
    pose: str, hip: Doubles, ground: Doubles, leg: tuple[float, float], sign: float, lifted: bool
) -> tuple[Doubles, bool]:
    """Return the position (3,) of a foot in a pose, and whether its toes lie flat.

    Args:
        pose: as for `Legs.grow`.
        hip: (3,) position of the leg's hip.
        ground: (3,) position of the foot if it stands.
        leg: lengths of thigh and shank.
        sign: 1 for the right leg, -1 for the left one.
        lifted: whether a bird that stands on one leg lifts this one.
    """
    thigh, shank = leg
    match pose:
        case "soar":
            return hip + (thigh + shank) * np.array([-0.82, -0.14, 0.0]), False
        case "land":
            return hip + (thigh + shank) * np.array([0.38, -0.72, 0.06 * sign]), False
        case "one_leg" if lifted:
            return by(hip, 0.55 * (shank - 0.4 * thigh), -0.55 * thigh, -0.03 * sign), False
        case "one_leg":
            return ground * [1.0, 1.0, 0.35], True  # near the middle, below the weight
        case _:
            return ground, True


def _comb(rng: Rng) -> list[Part]:
    """Return the comb and wattles of a cock or, smaller, of a hen."""
    size = rng.uniform(0.6, 1.25)
    edge = [(-0.42, 0.28), (-0.46, 0.60), (-0.28, 0.52), (-0.20, 0.80), (-0.06, 0.56), (0.06, 0.84),
            (0.18, 0.54), (0.32, 0.68), (0.40, 0.40), (0.30, 0.20)]  # fmt: skip
    outline = rounded([(x, 0.3 + (y - 0.3) * size) for x, y in edge], 1)
    lobe = tube([(0.34, -0.22, 0.10), (0.36, -0.22 - 0.36 * size, 0.14)], [0.08, 0.13], 0.05)
    crest = Plate(Frame(np.zeros(3), np.eye(3)), outline, rim=0.055)
    return [fuse(crest, blend=0.03), pair(lobe, blend=0.03)]


def _sickles(rng: Rng, factor: float) -> list[Part]:
    """Return the drooping tail feathers of a cock, or no parts for a hen."""
    if rng.uniform() < 0.5:
        return []
    arcs: list[Shape] = []
    for i in range(4):
        z, reach = 0.02 + 0.03 * i, factor * (1.25 - 0.14 * i)
        arc = np.array([(0.1, 0.1), (-0.12, 0.42), (-0.40, 0.60), (-0.66, 0.52), (-0.80, 0.26)]) * reach
        aside = np.array([1.0, 1.0, 1.4, 1.8, 2.0]) * z
        arcs += both(tube(np.column_stack([arc, aside]), [0.05, 0.065, 0.06, 0.05, 0.02], 0.018))
    return [fuse(*arcs, blend=0.01)]


def _tufts(rng: Rng) -> list[Part]:
    """Return an owl's rings of feathers around the eyes and, sometimes, ear tufts."""
    parts = [pair(tube([(0.30, 0.06, 0.17), (0.335, 0.06, 0.19)], 0.24, 0.24), blend=0.03),
             pair(tube([(0.40, 0.07, 0.19), (0.70, 0.075, 0.30)], 0.18), blend=0.05, carve=True),
             pair(tube([(0.30, 0.08, 0.18), (0.31, 0.08, 0.185)], 0.155))]  # fmt: skip
    if rng.uniform() < 0.6:
        line = [(0.16, 0.34, 0.22), (0.10, 0.52, 0.33), (0.02, 0.72, 0.42)]
        parts.append(pair(tube(line, [0.12, 0.09, 0.02], [0.07, 0.05, 0.02]), blend=0.06))
    return parts


def _plume(_: Rng) -> list[Part]:
    """Return the plumes at the back of a heron's head."""
    plume = tube([(-0.3, 0.18), (-0.75, 0.14), (-1.25, -0.12)], [0.07, 0.06, 0.02])
    return [fuse(plume, blend=0.04)]


def _brow(_: Rng) -> list[Part]:
    """Return the ridge over an eagle's eye."""
    ridge = tube([(-0.02, 0.21, 0.34), (0.20, 0.22, 0.31), (0.36, 0.15, 0.21)], [0.05, 0.06, 0.04])
    return [pair(ridge, blend=0.06)]


_FACES: Mapping[str, Callable[[Rng], list[Part]]] = {
    "brow": _brow, "comb": _comb, "plume": _plume, "tufts": _tufts,
}  # fmt: skip
_POSES = ("stand", "walk", "feed", "perch", "one_leg", "swim", "spread", "soar", "land")
_YOUNG_PROBABILITY = 0.15
_RANGES: Mapping[str, Span] = {
    "girth": (0.88, 1.15), "neck": (0.9, 1.12), "head": (0.92, 1.12), "beak": (0.85, 1.18),
    "tail": (0.8, 1.2), "legs": (0.88, 1.12), "wing": (0.9, 1.12),
}  # fmt: skip
_CHICK: Mapping[str, float] = {
    "girth": 1.0, "neck": 1.05, "head": 1.3, "beak": 0.7, "tail": 0.4, "legs": 0.85, "wing": 0.6,
}  # fmt: skip


@dataclass(frozen=True)
class Bird(PosedPlan):
    """A kind of bird.

    Args:
        body: stations of the horizontal body, from the rump at x = 0 to the breast at x = 1.
        pitch: upward angle of the breast when standing, in degrees.
        neck: stations from inside the breast to the head of the upright bird, relative to the first.
        low: the same stations of the feeding bird.
        skull_size: size of the head.
        skull: stations of the skull in its own frame, relative to its size, or the name of a shared skull.
        eye: right eye, in the skull's frame and unit.
        beak: upper half of the beak, in the skull's frame and unit.
        jaw: lower half of the beak, in the skull's frame and unit.
        wing: wings.
        tail: tail.
        leg: legs.
        face: crest, comb or tufts, or None.
        train: sickle feathers, or None.
        turn: maximum rotation of the head in degrees.
        chick: whether some individuals are chicks.
        ranges: ranges of proportions that differ from the defaults.

    Raises:
        InputError: if ``neck`` and ``low`` differ in the number of stations.
    """

    habits: tuple[Annotated[str, OneOf(_POSES)], ...]
    body: Profile
    pitch: Span
    neck: Stations
    low: Stations
    skull_size: Number
    skull: Profile
    eye: Eyeball
    beak: Stations
    jaw: Stations
    wing: Wing
    tail: Tail
    leg: Legs
    face: Annotated[str, OneOf(_FACES)] | None = None
    train: Literal["sickles"] | None = None
    turn: Number = 35.0
    chick: bool = False
    ranges: Mapping[Annotated[str, OneOf(_RANGES)], Span] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check that ``neck`` and ``low`` can be interpolated."""
        upright, low = len(self.neck.x), len(self.low.x)
        if upright != low:
            raise InputError(f"low has as many stations as neck, {upright}, not {low}.")

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        young = self.chick and pose in {"stand", "walk", "swim"} and bool(rng.uniform() < _YOUNG_PROBABILITY)
        build = proportions(_RANGES, self.ranges, rng, _CHICK if young else None)
        tilt = rng.uniform(*self.pitch)
        tilt = {"soar": 4.0, "swim": 0.6 * tilt, "feed": 0.35 * tilt - 8.0}.get(pose, tilt)
        turn = pitch(tilt)
        middle = turn @ np.array([0.5, 0.0, 0.0])
        body = Frame(-middle, turn)  # the centre of the body is at the origin, and the legs reach the ground

        girth = build["girth"]
        rows = replace(self.body, bottom=self.body.bottom * (0.5 + 0.5 * girth)).wider(girth)
        down = Ripple(0.004, 0.06) if young else None
        parts = [fuse(rows.sweep().placed(body), ripple=down)]
        neck, head = _neck(self, pose, build, body, rng)
        parts.append(replace(neck, ripple=down))
        parts += _head(self, build, head, rng, young)
        out = pose in {"soar", "spread", "land"}
        tail = self.tail
        widest = {"soar": 40.0, "spread": 46.0, "land": 60.0}
        # The ends of an open fan must touch.
        touching = 2.2 * tail.half_width * (tail.feathers - 1) / (tail.length + 0.16)
        spread = min(widest[pose], float(np.rad2deg(touching))) if out else tail.closed
        feathers = _fan(tail, build["tail"], spread * rng.uniform(0.8, 1.2), rng.normal(0, 5))
        if self.train is not None and not young:
            feathers += _sickles(rng, build["tail"])
        if out:
            feathers += _opened(self.wing, rows, build["wing"], pose, tilt, rng)
        else:
            feathers += _folded(self.wing, rows, build["wing"], young)
        parts += carried(feathers, body)
        if pose != "swim":
            parts += self.leg.grow(build["legs"], pose, body, rng)
        return parts


def _neck(kind: Bird, pose: str, build: Mapping[str, float], body: Frame, rng: Rng) -> tuple[Part, Frame]:
    fraction = rng.uniform(0.85, 1.0) if pose == "feed" else rng.uniform(0.0, 0.22)
    up, low = kind.neck, kind.low
    points = up.points + fraction * (low.points - up.points)
    if pose == "soar":  # stretched forward, or retracted like a heron's
        points[:, 1] *= 0.25
        points[:, 0] += 0.5 * np.abs(up.y)
    points *= build["neck"]
    points += body.place([0.86, 0.02, 0.0])
    aside = float(np.clip(rng.normal(0, 0.35), -1, 1)) * kind.turn
    bent, _ = bend(points, 0.0, 0.4 * aside)
    radii = up.radius + fraction * (low.radius - up.radius)
    sweep = tube(bent, radii * np.linspace(1.0, build["head"], len(bent)))
    nod = rng.uniform(-8, 10) - (38.0 * fraction if pose == "feed" else 0.0)
    return fuse(sweep, blend=0.14), Frame(bent[-1], yaw(aside) @ pitch(nod))


def _head(kind: Bird, build: Mapping[str, float], frame: Frame, rng: Rng, young: bool) -> list[Part]:
    size = kind.skull_size * build["head"]
    parts = [
        fuse(kind.skull.sweep(), blend=0.35),
        fuse(_beak(kind.beak, build["beak"]), blend=0.06),
        fuse(_beak(kind.jaw, build["beak"]), blend=0.02),
        pair(ball(kind.eye.at, kind.eye.radius * (1.2 if young else 1.0))),
    ]
    if kind.face is not None and not young:
        parts += _FACES[kind.face](rng)
    return carried(parts, frame, size)


def _beak(rows: Stations, length: float) -> Sweep:
    longer = replace(rows, x=rows.x[0] + (rows.x - rows.x[0]) * length)
    return tube(longer.points, rows.radius, rows.widths)


def _folded(wing: Wing, body: Profile, factor: float, young: bool) -> list[Part]:
    """Return the folded wings: flight feathers and two rows of coverts, or stubs for a young bird."""
    tip = -wing.folded * factor
    layers = [
        (0.80, 0.30, 0.75, 0.030) if young else (0.74, tip, 0.78, 0.022),
        (0.84, 0.14 + 0.35 * tip, 1.0, 0.034),
        (0.88, 0.36, 0.86, 0.048),
    ]
    parts = []
    for number, (first, last, deep, thick) in enumerate(layers[:1] if young else layers):
        x = np.linspace(first, last, 6)
        at = wing.high + (0.32 - wing.high) * np.clip((0.3 - x) / 0.6, 0, 1)  # the tips meet over the rump
        points = np.column_stack([x, *_on_body(body, np.maximum(x, 0.04), at)])
        behind = np.clip(0.1 - x, 0, None)
        points[:, 2] = np.maximum(points[:, 2] - 0.55 * behind, 0.035) + 0.006 * number
        points[:, 1] += 0.10 * behind
        outline = np.array([0.42, 0.86, 1.0, 0.92, 0.62, 0.16]) * wing.depth * deep
        parts.append(pair(tube(points, outline, thick, (0.0, -0.12, 1.0)), blend=0.012))
    return parts


def _on_body(body: Profile, x: Doubles, high: Doubles) -> tuple[Doubles, Doubles]:
    """Return y and z of points on the right side of the body, with ``high`` from -1 (belly) to 1 (back)."""
    top, bottom, wide = body.at(x)
    y = (top + bottom) / 2 + high * (top - bottom) / 2
    return y, wide * np.sqrt(1 - high**2)


def _opened(wing: Wing, body: Profile, factor: float, pose: str, tilt: float, rng: Rng) -> list[Part]:
    """Return the spread wings, which partly follow the pitch ``tilt`` of the body in degrees."""
    span = wing.span * factor
    y, z = _on_body(body, np.array([0.74]), np.array([0.45]))
    shoulder = np.array([0.74, y[0], 0.7 * z[0]])
    raised = {"soar": (-4.0, 20.0), "spread": (8.0, 38.0), "land": (28.0, 55.0)}[pose]
    lift, sweep = rng.uniform(*raised), rng.uniform(-6, 12)
    flap = rng.uniform(0.0, 16.0)
    bones = _bones(span)
    feathers = _feathers(wing, bones, span)
    # The hand is raised slightly more than the arm.
    hand = about((0.0, 0.0, 0.5 * span), roll(flap))
    whole = about(shoulder, pitch(-0.55 * tilt if pose != "soar" else 0.0) @ roll(lift) @ yaw(-sweep))
    outer = [feather.placed(hand) for feather in feathers[: wing.primaries]]

    def placed(shapes: Sequence[Sweep], blend: float) -> Part:
        return pair(*(each.placed(Frame(shoulder, np.eye(3))).placed(whole) for each in shapes), blend=blend)

    return [placed([*outer, *feathers[wing.primaries :]], 0.0), placed(_arm(wing, bones), 0.02)]


def _bones(span: float) -> Doubles:
    """Return shoulder, elbow, wrist and the end of the hand, (4, 3), of a wing spread to the right."""
    return span * np.array([[0, 0, 0], [-0.05, 0.012, 0.26], [0.075, 0.018, 0.50], [0.045, 0.01, 0.66]])


def _arm(wing: Wing, bones: Doubles) -> list[Sweep]:
    """Return the arm with its coverts, thick at the front and thin at the back."""
    back = np.array([[-0.42], [-0.34], [-0.26], [-0.12]]) * wing.chord * [1.0, 0.0, 0.0]
    wide = np.array([0.50, 0.42, 0.34, 0.16]) * wing.chord
    cover = tube(bones + back * 0.8, wide, [0.050, 0.036, 0.028, 0.018], (0.0, 1.0, 0.0))
    bone = tube(bones, [0.075, 0.055, 0.045, 0.02], [0.06, 0.045, 0.035, 0.02], (0.0, 1.0, 0.0))
    return [cover, bone]


def _feathers(wing: Wing, bones: Doubles, span: float) -> list[Sweep]:
    """Return the flight feathers of the right wing from the tip inwards, those of the hand first."""
    half = wing.width * 0.075 * span

    def feather(base: Doubles, degrees: float, length: float, number: int) -> Sweep:
        angle = np.deg2rad(degrees)
        over = np.array([0.0, _STEP * (number % 2), 0.0])
        end = base + np.array([-np.sin(angle), 0, np.cos(angle)]) * (length - half)
        return tube([base + over, end + over], [half * 0.9, half], _THIN, (0, 1, 0))

    feathers = []
    longest = 0.36 * span + 0.15 * wing.chord
    for i in range(wing.primaries):
        t = i / (wing.primaries - 1)
        # The longest feather is the outermost in a pointed wing and the third or fourth in a broad wing.
        dip = (1 - wing.pointed) * 0.22 * max(0.0, 1 - 4 * t)
        reach = (longest + (wing.chord * 1.02 - longest) * t**0.8) * (1 - dip)
        feathers.append(feather(bones[3] + t * (bones[2] - bones[3]), 8 + 66 * t**0.9, reach, i))
    inner = max(6, wing.primaries - 2)
    for i in range(inner):
        t = (i + 0.7) / inner
        base = bones[2] + (bones[1] - bones[2]) * min(2 * t, 1) + (bones[0] - bones[1]) * max(2 * t - 1, 0)
        feathers.append(feather(base, 78 + 14 * t, wing.chord * (1.0 - 0.12 * t), i))
    return feathers


def _fan(tail: Tail, factor: float, spread: float, aside: float) -> list[Part]:
    """Return the tail with outermost feathers ``spread`` degrees apart, rotated ``aside`` degrees left."""
    count, half, raised = tail.feathers, tail.half_width, tail.raised
    feathers = []
    for i in range(count):
        t = 2 * i / (count - 1) - 1
        turn = pitch(-raised) @ yaw(aside + t * spread / 2)
        way = turn @ np.array([-1.0, 0.0, 0.0])
        start = np.array([0.16, 0.03, 0.0])
        over = turn @ np.array([0.0, _STEP * (1 - abs(t)) * 2.0 + _STEP * (i % 2), 0.0])
        end = start + way * (tail.length * factor + 0.16 - half) * (1 - 0.08 * t * t) + over
        upward = turn @ np.array([0.0, 1.0, 0.0])
        feathers.append(tube([start + over, end], [0.7 * half, half], _THIN, upward))
    rear = pitch(-raised) @ np.array([-0.12, 0.0, 0.0]) + [0.05, 0.03, 0.0]
    rump = tube([np.array([0.22, 0.03, 0.0]), rear], [0.10, 0.04], [0.11, 0.05])
    return [fuse(*feathers, blend=0.01), fuse(rump, blend=0.08)]


def _toes(shape: Legs, foot: Doubles, heading: float, flat: bool, rng: Rng) -> list[Sweep]:
    toes = []
    for angle in _TOES:
        length = shape.toe * {0.0: 1.0, 180.0: 0.55}.get(angle, 0.88)
        turn = yaw(heading + angle + rng.normal(0, 3))
        drop = 0.0 if flat else (-0.5 if abs(angle) < 90 else -0.8)
        r = shape.thick
        bones = in_space([(0, 0), (0.35, 0.08 + 0.35 * drop), (0.75, 0.02 + 0.75 * drop), (1.0, drop - 0.03)])
        points = foot + bones * length @ turn.T
        if flat:
            points[:, 1] = np.maximum(points[:, 1], foot[1] - 0.2 * r)
        toes.append(tube(points, [r, 0.85 * r, 0.75 * r, shape.claws * r]))
    return toes


def _web(shape: Legs, foot: Doubles, heading: float, flat: bool) -> Plate:
    reach = 0.95 * shape.toe
    tips = [(reach * np.cos(a), reach * np.sin(a)) for a in np.deg2rad([-36, -18, 0, 18, 36])]
    dents = [(0.9 * x, 0.9 * y) if i in {1, 3} else (x, y) for i, (x, y) in enumerate(tips)]
    outline = rounded([(-0.1 * reach, -0.06 * reach), *dents, (-0.1 * reach, 0.06 * reach)], 1)
    lay = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # with axes x, -z, y
    slope = pitch(0.0 if flat else float(np.rad2deg(-0.5)))
    return Plate(Frame(foot, yaw(heading) @ slope @ lay.T), outline, rim=0.6 * shape.thick)
