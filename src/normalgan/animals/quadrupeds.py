"""The body plan of quadrupeds: settings of a species, and parts of an individual by build and pose."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from normalgan.animals.dinosaurs import Armour
from normalgan.animals.frames import Frame, bend, fold, pitch, unit, yaw
from normalgan.animals.parts import Part, Ripple, both, fuse, on_side, pair, tube
from normalgan.animals.plan import Rng, drawn_pose, proportions
from normalgan.animals.quadrupeds_poses import POSES, POSTURES, Pose
from normalgan.animals.shapes import Cut, Shape, Sweep
from normalgan.animals.stations import Profile, Stations
from normalgan.animals.tables import Kinds, Number, Point, Span, Table
from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.ranges import Count, OneOf

_SEATED = 0.82  # sitting animals have a round back, which brings shoulder and hip closer
_FACE = 0.4  # fraction of the head's length from the poll that the muzzle factor does not affect
_BELOW_BELLY = 0.6  # fraction of the height that scales with the legs
_LIP = 0.02  # radius of the groove of the mouth, in units of the head's length
_PROUD = 0.007  # distance of its centre outside the skull, so that it does not cut through thin muzzles


_Build = Mapping[str, float]
"""Factors, named as in `_RANGES`, by which an individual differs from its species."""
_RANGES: Mapping[str, Span] = {
    "length": (0.93, 1.07),  # length of the torso
    "depth": (0.92, 1.08),  # depth of the belly below the back
    "girth": (0.9, 1.15),  # width of the torso
    "legs": (0.93, 1.07),  # length of the legs
    "bone": (0.9, 1.15),  # thickness of the legs
    "neck": (0.92, 1.1),  # length of the neck
    "crest": (0.92, 1.12),  # thickness of the neck
    "head": (0.94, 1.08),  # size of the head
    "muzzle": (0.92, 1.08),  # length of the face in front of the eyes
    "ears": (0.85, 1.2),  # length of the ears
    "horns": (0.75, 1.25),  # length of horns, antlers, tusks
    "tail": (0.85, 1.15),  # length of the tail
    "humps": (0.8, 1.2),  # height of the humps
}
_YOUNG: Mapping[str, float] = {
    "legs": 1.08, "bone": 0.95, "girth": 0.88, "depth": 0.86, "length": 0.9, "head": 1.12, "muzzle": 0.88,
    "neck": 0.92, "ears": 1.1, "horns": 0.35, "tail": 0.8,
}  # fmt: skip
_YOUNG_PROBABILITY = 0.12


@dataclass(frozen=True)
class LegTemplate(Table):
    """A leg at rest, in units of the height of its uppermost joint.

    Args:
        stations: stations from the top down; x forward from the uppermost joint, y above the ground.
        joints: indices of the joints among the stations: shoulder, elbow, wrist, fetlock; or hip, knee,
            hock, fetlock.
        sole: whether the foot has a flat end.

    Raises:
        InputError: if a joint is not a station.
    """

    stations: Stations
    joints: tuple[Count, Count, Count, Count]
    sole: bool = True

    def __post_init__(self) -> None:
        """Check the joints."""
        if not all(0 <= joint < len(self.stations.x) for joint in self.joints):
            raise InputError(f"joints are stations, which go from 0 to {len(self.stations.x) - 1}.")


@dataclass(frozen=True)
class Limb(Table):
    """A pair of legs.

    Args:
        template: shape of the legs, or the name of a shared shape.
        x: x of the uppermost joint, forward.
        y: y of the uppermost joint, above the ground.
        z: z of the uppermost joint, from the middle plane.
        foot: z of the foot.
        thick: factor of the template's radii.
    """

    template: LegTemplate
    x: Number
    y: Number
    z: Number
    foot: Number
    thick: Number = 1.0


@dataclass(frozen=True)
class Ornament(Table):
    """A feature of the body or head, such as a horn, nose, hump or lop ear.

    Args:
        stations: stations in units of the height at the withers or, on the head, of its length.
        scale: name of the factor in `_RANGES` that stretches the ornament from its pivot; None for
            ornaments of the head that only scale with it.
        side: direction of the width.
        mirror: whether there is a mirror image on the left.
        blend: width of the blend.
        carve: whether to subtract the ornament instead of adding it.
        swivel: twice the standard deviation of the random rotation, in degrees.
        chance: probability of the ornament.
        ripple: bumps, or None.
        pivot: centre of stretching and rotation; None for the first station.
        otherwise: whether the ornament appears exactly if the previous one does not, regardless of
            ``chance``.
    """

    stations: Stations
    scale: Annotated[str, OneOf(_RANGES)] | None = None
    side: Point = (0.0, 0.0, 1.0)
    mirror: bool = True
    blend: Number = 0.01
    carve: bool = False
    swivel: Number = 0.0
    chance: Number = 1.0
    ripple: Ripple | None = None
    pivot: Point | None = None
    otherwise: bool = False


def _nostrils(at: Point, radius: Number) -> Ornament:
    """Return a pair of nostrils, to be subtracted.

    Args:
        at: position of the right nostril, in head lengths.
        radius: radius of a nostril.
    """
    x, y, z = np.column_stack([at, np.add(at, (0.04, 0.02, -0.01))])
    return Ornament(Stations(x, y, np.array([radius, 0.8 * radius]), z), carve=True, blend=0.008)


def _ears(
    base: Point,
    tip: Point,
    half_width: Number,
    thick: Number,
    side: Point,
    swivel: Number = 18.0,
    pricked: bool = False,
    chance: Number = 1.0,
) -> Ornament:
    """Return a pair of leaf-shaped ears, wide in the middle and pointed.

    Args:
        base: base of the right ear, in head lengths.
        tip: tip of the right ear.
        half_width: half of the maximum width.
        thick: half of the thickness.
        side: direction of the width.
        swivel: twice the standard deviation of the random rotation, in degrees.
        pricked: whether the ears are widest at the base instead, like a cat's.
        chance: probability of the ears.
    """
    outline = np.array((1.0, 0.95, 0.78, 0.5, 0.12) if pricked else (0.55, 0.88, 1.0, 0.72, 0.16))
    t = np.linspace(0, 1, 5)
    x, y, z = (a + (b - a) * t for a, b in zip(base, tip, strict=True))
    stations = Stations(x, y, thick * (1.15 - 0.4 * t), z, half_width * outline)
    return Ornament(stations, scale="ears", side=side, blend=0.015, swivel=swivel, chance=chance)


@dataclass(frozen=True)
class Eye(Table):
    """The right eye on the surface of the skull.

    Args:
        x: position along the head.
        angle: angle above the middle of the side, in degrees.
        radius: radius of the eyeball.
    """

    x: Number
    angle: Number
    radius: Number


@dataclass(frozen=True)
class Mouth(Table):
    """The groove between the lips.

    Args:
        x: position of its corner along the head.
        angle: angle of its corner above the middle of the side, in degrees; negative below.
    """

    x: Number
    angle: Number


@dataclass(frozen=True)
class Head(Table):
    """The skull and its features, in head lengths in the head's frame: x to the nose, y up, 0 at the poll.

    Args:
        length: length of the head, in units of the height at the withers.
        pitch: pitch of the face at rest in degrees, negative downwards.
        skull: stations of the skull.
        eye: right eye.
        ornaments: nose, nostrils, ears and horns in blending order.
        mouth: groove of the mouth; None for a closed mouth.
        flat: whether the snout has a flat end.
    """

    length: Number
    pitch: Number
    skull: Profile
    eye: Eye
    ornaments: tuple[Annotated[Ornament, Kinds(tube=Ornament, nostrils=_nostrils, ears=_ears)], ...]
    mouth: Mouth | None = None
    flat: bool = False


@dataclass(frozen=True)
class Mane(Table):
    """A crest along the neck.

    Args:
        height: height above the neck's spine, in neck radii.
        radius: radius of the mane.
        half_width: half of its width.
        aside: displacement to one side, in neck widths.
        bumps: height of bumps; 0 for no bumps.
    """

    height: Number
    radius: Number
    half_width: Number
    aside: Number = 0.0
    bumps: Number = 0.0


@dataclass(frozen=True)
class Quadruped(Table):
    """A kind of quadruped in a standing pose: head towards +x, ground at y = 0, withers about 1 high.

    Args:
        habits: poses of the species; a pose listed twice is drawn twice as often.
        torso: stations from the buttocks to the chest.
        neck: stations from inside the chest to the poll.
        head: head.
        fore: forelegs.
        hind: hind legs.
        tail: stations from inside the croup to the tip.
        ornaments: humps and udders, in the body's frame.
        mane: mane, or None.
        armour: plates, spikes or a frill, or None.
        ranges: ranges that replace entries of `_RANGES`.
        tail_lift: range of the tail's pitch in degrees.
        tail_ripple: bumps on the tail, or None.
        coat: bumps on torso and neck, or None.
        ruff: bumps on the neck, if they differ from the coat's.
        neck_pitch: range of the neck's pitch relative to rest, in degrees.
    """

    habits: tuple[Annotated[str, OneOf(POSES)], ...]
    torso: Profile
    neck: Stations
    head: Head
    fore: Limb
    hind: Limb
    tail: Stations
    ornaments: tuple[Ornament, ...] = ()
    mane: Mane | None = None
    armour: Armour | None = None
    ranges: Mapping[Annotated[str, OneOf(_RANGES)], Span] = field(default_factory=dict)
    tail_lift: Span = (-10.0, 25.0)
    tail_ripple: Ripple | None = None
    coat: Ripple | None = None
    ruff: Ripple | None = None
    neck_pitch: Span = (-15.0, 12.0)

    @property
    def poses(self) -> tuple[str, ...]:
        """All common and rare poses and postures; armoured animals have only their habits."""
        return (*POSES, *POSTURES) if self.armour is None else tuple(dict.fromkeys(self.habits))

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return the parts of a random individual."""
        young = _YOUNG if rng.uniform() < _YOUNG_PROBABILITY else None
        build = proportions(_RANGES, self.ranges, rng, young)
        drawn = drawn_pose(self.habits, pose, rng)
        return _assemble(self, build, (POSES[drawn] if drawn in POSES else POSTURES[drawn])(rng), rng)


def _assemble(species: Quadruped, build: _Build, pose: Pose, rng: Rng) -> list[Part]:
    """Return the parts in blending order.

    Legs have a sharp union with each other, so that they do not merge, and a soft union with the torso.
    ``rng`` only draws details such as the rotation of ears or the presence of horns.
    """
    if pose.sit:
        build = {**build, "length": _SEATED * build["length"]}
    body = _body(species, build, pose)
    torso = _torso(species, build, body)
    neck, head = _neck(species, build, pose, body)
    tail = _tail(species, build, pose, body)
    size = species.head.length * build["head"]
    skull = _skull(species.head, build["muzzle"]).placed(head, size)
    limbs = (species.fore, species.fore, species.hind, species.hind)
    legs = [
        on_side(_leg(limb, build, angles, stance, body), right=i % 2 == 0)
        for i, (limb, angles, stance) in enumerate(zip(limbs, pose.legs, pose.stance, strict=True))
    ]
    parts = [
        fuse(torso, ripple=species.coat),
        fuse(neck, blend=0.12, ripple=species.ruff or species.coat),
        fuse(skull, blend=0.1 * species.head.length),
        pair(_shoulder_blade(species.fore, build, body), blend=0.06),
        fuse(*legs, blend=0.055),
        fuse(tail, blend=0.03, ripple=species.tail_ripple),
    ]
    if species.mane is not None:
        parts.append(_crest(neck, species.mane, 1.0 if rng.uniform() < 0.5 else -1.0))
    parts += _face(species.head, build["muzzle"], head, size)
    parts += [_ornament(item, 1.0, build, body, rng) for item in _chosen(species.ornaments, rng)]
    for item in _chosen(species.head.ornaments, rng):
        parts.append(_ornament(item, size, build, head, rng, build["muzzle"]))
    if species.armour is not None:
        parts += species.armour.grow(neck, skull, torso, tail, rng)
    return parts


def _chosen(items: Sequence[Ornament], rng: Rng) -> list[Ornament]:
    chosen: list[Ornament] = []
    before = True
    for item in items:
        before = not before if item.otherwise else bool(rng.uniform() < item.chance)
        if before:
            chosen.append(item)
    return chosen


def _body(species: Quadruped, build: _Build, pose: Pose) -> Frame:
    hip = np.array([species.hind.x * build["length"], species.hind.y, 0.0])
    turn, up = pitch(pose.pitch), 0.0
    if pose.sit:
        up = _ground(build) - _hang(species.hind, build, pose.legs[2])[-1, 1] - hip[1]
        shoulder = np.array([species.fore.x * build["length"], species.fore.y, 0.0]) - hip
        rise = species.fore.y - hip[1] - up  # so that the straight forelegs reach the ground
        reach = float(np.hypot(shoulder[0], shoulder[1]))
        angle = np.arcsin(min(rise / reach, 0.85)) - np.arctan2(shoulder[1], shoulder[0])
        turn = pitch(float(np.rad2deg(angle)))
    return Frame(hip + np.array([0.0, up, 0.0]) - turn @ hip, turn)


def _torso(species: Quadruped, build: _Build, body: Frame) -> Sweep:
    x, top, bottom = species.torso.x, species.torso.top, species.torso.bottom
    middle = np.sin(np.linspace(0, np.pi, len(x)))  # belly and waist vary, but breast and buttocks hardly do
    deeper = top - (top - bottom) * (1 + (build["depth"] - 1) * middle)
    torso = Profile(x * build["length"], top, deeper, species.torso.half_width * build["girth"])
    return torso.sweep().placed(body)


def _neck(species: Quadruped, build: _Build, pose: Pose, body: Frame) -> tuple[Sweep, Frame]:
    """Return the neck and the frame of the head."""
    rows, points = species.neck, species.neck.points
    points[:, 0] += species.fore.x * (build["length"] - 1)
    points = points[0] + (points - points[0]) * build["neck"]
    low, high = species.neck_pitch
    up = low + (high - low) * pose.neck_pitch
    if pose.sit:
        up -= 0.6 * float(np.rad2deg(np.arcsin(body.rotation[1, 0])))
    angle = species.head.pitch + pose.head_pitch + 0.25 * up
    if pose.graze:
        up, angle = _lowered(species, build, points, body)
    moved, turns = bend(points, up, pose.neck_yaw)
    upright = np.eye(3) if pose.sit else body.rotation
    rotation = upright @ yaw(pose.neck_yaw + pose.head_yaw) @ pitch(angle)
    placed = body.place(moved)
    grow = np.linspace(1, build["head"], len(points)) * build["crest"]
    sweep = tube(placed, rows.radius * grow, rows.widths * grow, (body.rotation @ turns)[:, :, 2])
    return sweep, Frame(placed[-1], rotation)


def _lowered(species: Quadruped, build: _Build, points: Doubles, body: Frame) -> tuple[float, float]:
    """Return the pitch of neck and head in degrees for a muzzle near the ground, found by bisection."""
    skull = species.head.skull
    tip = np.array([_stretch(skull.x[-1:], build["muzzle"])[0], skull.bottom[-1], 0.0])
    tip = tip * species.head.length * build["head"]

    def head_angle(up: float) -> float:
        return max(species.head.pitch + 0.35 * up, -72.0)

    high, low = 20.0, -170.0
    for _ in range(30):
        up = (high + low) / 2
        poll = bend(points, up, 0.0)[0][-1]
        clearance = body.place(poll + pitch(head_angle(up)) @ tip)[1] - _ground(build)
        high, low = (up, low) if clearance > 0.03 else (high, up)
    return up, head_angle(up)


def _tail(species: Quadruped, build: _Build, pose: Pose, body: Frame) -> Sweep:
    rows, points = species.tail, species.tail.points
    points[:, 0] *= build["length"]
    points = points[0] + (points - points[0]) * build["tail"]
    low, high = species.tail_lift
    # The chain of the tail runs backwards, so raising it is a negative pitch.
    moved, turns = bend(points, -(low + (high - low) * pose.tail_lift), pose.tail_swing)
    placed = body.place(moved)
    if pose.sit:
        placed[:, 1] = np.maximum(placed[:, 1], _ground(build) + rows.radius)
    return tube(placed, rows.radius, side=(body.rotation @ turns)[:, :, 2])


def _crest(neck: Sweep, mane: Mane, sign: float) -> Part:
    tangents = np.gradient(neck.points, axis=0)
    dorsal = np.cross(neck.sides, tangents)
    dorsal /= np.linalg.norm(dorsal, axis=1, keepdims=True)
    points = neck.points + dorsal * (neck.radii * mane.height)[:, None]
    points += neck.sides * (neck.widths * mane.aside * sign)[:, None]
    ripple = Ripple(mane.bumps, 0.06) if mane.bumps else None
    return fuse(tube(points, mane.radius, mane.half_width, neck.sides), blend=0.01, ripple=ripple)


def _ground(build: _Build) -> float:
    """Return the height of the ground, 0 for legs of the species' default length."""
    return _BELOW_BELLY * (1 - build["legs"])


def _hang(limb: Limb, build: _Build, angles: tuple[float, ...]) -> Doubles:
    """Return the folded stations (n + 1, 3), relative to the uppermost joint; the last one is the sole."""
    rows = limb.template.stations
    length = limb.y - _ground(build)
    forward = np.append(rows.x, rows.x[-1]) * length
    height = np.append(rows.y, 0.0)
    across = (limb.foot - limb.z) * (1 - height)
    points = np.column_stack([forward, (height - 1) * length, across])
    return fold(points, limb.template.joints, angles)


def _leg(limb: Limb, build: _Build, angles: tuple[float, ...], stance: bool, body: Frame) -> Sweep:
    """Return a right leg; standing legs are stretched or shortened so that the sole is on the ground."""
    rows = limb.template.stations
    points = _hang(limb, build, angles)
    root = body.place([limb.x * build["length"], limb.y, limb.z * build["girth"]])
    if stance:
        points[:, 1] *= (_ground(build) - root[1]) / points[-1, 1]
    points += root
    widen = np.interp(rows.y, [0.5, 0.9], [build["bone"], build["bone"] ** 0.5])
    thick = limb.thick * limb.y * widen
    sole = np.array([0.0, -1.0, 0.0]) if stance else unit(points[-1] - points[-2])
    cut = Cut(points[-1], sole) if limb.template.sole else None
    return replace(tube(points[:-1], rows.radius * thick, rows.widths * thick), cut=cut)


def _shoulder_blade(limb: Limb, build: _Build, body: Frame) -> Sweep:
    """Return the flat muscle from the point of the right shoulder up and back to the withers."""
    x, size, girth = limb.x * build["length"], limb.y * limb.thick, build["girth"]
    points = [
        [x, limb.y, limb.z * girth],
        [x - 0.07, limb.y + 0.14, (0.85 * limb.z + 0.01) * girth],
        [x - 0.13, limb.y + 0.25, 0.52 * limb.z * girth],
    ]
    radii, widths = np.array([0.13, 0.115, 0.075]) * size, np.array([0.085, 0.060, 0.040]) * size
    return tube(points, radii, widths).placed(body)


def _stretch(x: Doubles, muzzle: float) -> Doubles:
    """Return positions along the head after stretching the face in front of the eyes."""
    return x + (muzzle - 1) * np.maximum(x - _FACE, 0)


def _skull(head: Head, muzzle: float) -> Sweep:
    """Return the head without ornaments, in head lengths in its own frame."""
    sweep = replace(head.skull, x=_stretch(head.skull.x, muzzle)).sweep()
    return replace(sweep, cut=Cut(sweep.points[-1], np.array([1.0, 0.0, 0.0]))) if head.flat else sweep


def _ornament(
    item: Ornament, size: float, build: _Build, frame: Frame, rng: Rng, muzzle: float = 1.0
) -> Part:
    """Return an ornament or a pair of them, in units of ``size``, on a face stretched by ``muzzle``."""
    points, radii, widths = item.stations.points, item.stations.radius * size, item.stations.widths * size
    factor = 1.0 if item.scale is None else build[item.scale]
    pivot = points[0] if item.pivot is None else np.array(item.pivot)
    points = pivot + (points - pivot) * factor
    points[:, 0] = _stretch(points[:, 0], muzzle)
    sweeps = []
    for sign in (1.0, -1.0) if item.mirror else (1.0,):
        turn = pitch(rng.normal(0, 0.5) * item.swivel) @ yaw(rng.normal(0, 0.5) * item.swivel)
        flip = np.diag([1.0, 1.0, sign])
        placed = frame.place((pivot + (points - pivot) @ turn.T) @ flip * size)
        side = frame.rotation @ flip @ turn @ np.array(item.side)
        sweeps.append(tube(placed, radii, widths, side))
    return fuse(*sweeps, blend=item.blend, carve=item.carve, ripple=item.ripple)


def _on_skull(head: Head, x: float, degrees: float) -> Doubles:
    """Return a point (3,) on the right half of the skull, in head lengths, at a given angle.

    The skull is a union of ellipsoids around all stations. Where it tapers steeply, its surface is outside
    the nearest station's section, so a ray from the axis is intersected with all nearby ellipsoids. The
    angle is 0° at the side, 90° at the crown, and -90° below the jaw.
    """
    skull, count = head.skull, len(head.skull.x)
    at, top, bottom, widths = (
        np.interp(np.linspace(0, count - 1, 200), np.arange(count), column)
        for column in (skull.x, skull.top, skull.bottom, skull.half_width)
    )
    middles, radii = (top + bottom) / 2, (top - bottom) / 2
    start = float(np.interp(x, at, middles))
    up, out = np.sin(np.deg2rad(degrees)), np.cos(np.deg2rad(degrees))
    a = (up / radii) ** 2 + (out / widths) ** 2
    b = up * (start - middles) / radii**2
    c = ((x - at) / radii) ** 2 + ((start - middles) / radii) ** 2 - 1
    root = np.sqrt(np.maximum(b * b - a * c, 0))
    far = float(np.max(np.where(b * b >= a * c, (root - b) / a, 0.0)))
    return np.array([x, start + far * up, far * out])


def _face(head: Head, muzzle: float, frame: Frame, size: float) -> list[Part]:
    """Return the carved eye sockets and, if there is one, the groove of the mouth, and the eyeballs."""
    x, angle, radius = head.eye.x, head.eye.angle, head.eye.radius
    at = np.array([_on_skull(head, x, angle), _on_skull(head, x + 0.02, angle)])
    socket = tube(at + radius * np.array([0.5, 0.1, 0.35]), 1.15 * radius)
    eyeball = tube(at - radius * np.array([0.0, 0.0, 0.35]), radius)

    def placed(sweep: Sweep) -> tuple[Shape, ...]:
        stretched = np.column_stack([_stretch(sweep.points[:, 0], muzzle), sweep.points[:, 1:]])
        return tuple(each.placed(frame, size) for each in both(replace(sweep, points=stretched)))

    parts = [fuse(*placed(socket), blend=0.05 * size, carve=True), fuse(*placed(eyeball))]
    if head.mouth is not None:
        lips = tube(_lips(head, head.mouth), _LIP)
        parts.append(fuse(*placed(lips), blend=0.01 * head.length, carve=True))
    return parts


def _lips(head: Head, mouth: Mouth) -> Doubles:
    """Return the points (7, 3) between the lips, from the right corner to the middle in front."""
    end = float(head.skull.x[-1])
    along = zip(np.linspace(mouth.x, end, 5), np.linspace(mouth.angle - 12, mouth.angle, 5), strict=True)
    side = np.array([_on_skull(head, float(x), float(angle)) for x, angle in along])
    side[:, 2] += _PROUD
    rows = head.skull.stations
    # The muzzle ends in a semi-ellipsoid that is as deep as it is high.
    ahead, up = np.cos(np.deg2rad(mouth.angle)), np.sin(np.deg2rad(mouth.angle))
    cap = np.array([end + _PROUD + rows.radius[-1] * ahead, rows.y[-1] + rows.radius[-1] * up, 0.0])
    bow = side[-1] * 0.3 + cap * 0.7 + np.array([0.0, 0.0, 0.25 * side[-1, 2]])
    return np.vstack([side, bow, cap])
