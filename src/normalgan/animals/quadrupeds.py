"""The quadrupeds' body plan: the settings of a species, and the parts of an individual by build and pose."""

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

__all__ = ["Eye", "Head", "LegTemplate", "Limb", "Mane", "Mouth", "Ornament", "Quadruped"]

_SEATED = 0.82  # the back of an animal that sits is rounded, which brings shoulder and hip nearer
_FACE = 0.4  # share of the head's length, from the poll, behind which the muzzle's length changes nothing
_BELOW_BELLY = 0.6  # share of the height that longer legs add to
_LIP = 0.02  # radius of the groove of the mouth, in units of the head's length
_PROUD = 0.007  # how far its middle lies outside the skull, so that it does not cut thin muzzles through


_Build = Mapping[str, float]
"""The factors of `_RANGES` by which an individual differs from the drawing of its species."""
_RANGES: Mapping[str, Span] = {
    "length": (0.93, 1.07),  # of the torso
    "depth": (0.92, 1.08),  # of the belly, measured down from the back
    "girth": (0.9, 1.15),  # width of the torso
    "legs": (0.93, 1.07),  # their length
    "bone": (0.9, 1.15),  # thickness of the legs
    "neck": (0.92, 1.1),  # its length
    "crest": (0.92, 1.12),  # thickness of the neck
    "head": (0.94, 1.08),  # its size
    "muzzle": (0.92, 1.08),  # length of the face before the eyes
    "ears": (0.85, 1.2),  # their length
    "horns": (0.75, 1.25),  # length of horns, antlers, tusks
    "tail": (0.85, 1.15),  # its length
    "humps": (0.8, 1.2),  # their height
}
_YOUNG: Mapping[str, float] = {
    "legs": 1.08, "bone": 0.95, "girth": 0.88, "depth": 0.86, "length": 0.9, "head": 1.12, "muzzle": 0.88,
    "neck": 0.92, "ears": 1.1, "horns": 0.35, "tail": 0.8,
}  # fmt: skip
_YOUNG_SHARE = 0.12


@dataclass(frozen=True)
class LegTemplate(Table):
    """A leg at rest, in units of the height of its uppermost joint.

    Args:
        stations: from the top down; x forward of the uppermost joint, y above the ground.
        joints: stations at which it bends: shoulder, elbow, wrist, fetlock; or hip, knee, hock, fetlock.
        sole: whether the foot ends flat.

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
        template: their shape, or the name of a shared one.
        x: x of the uppermost joint, forward.
        y: y of the uppermost joint, above the ground.
        z: z of the uppermost joint, from the middle.
        foot: z of the foot.
        thick: factor on the template's radii.
    """

    template: LegTemplate
    x: Number
    y: Number
    z: Number
    foot: Number
    thick: Number = 1.0


@dataclass(frozen=True)
class Ornament(Table):
    """Something on the body or head: horn, nose, hump, lop ear.

    Args:
        stations: in units of the height at the withers; on the head, of its length.
        scale: the factor of `_RANGES` that stretches it from its pivot; None for an ornament of the head that
            only scales with it.
        side: direction of the width.
        mirror: whether the left side has one too.
        blend: width of the blend.
        carve: dig instead of add.
        swivel: degrees by which its direction may differ from one individual to the next.
        chance: share of the individuals that have it.
        ripple: bumps, or None.
        pivot: the centre of stretching and swivelling; None for its first station.
        otherwise: it is there if the one before it is not, whatever its chance.
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
        at: the right one, in units of the head's length.
        radius: its radius.
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
    """Return a pair of ears shaped like leaves: wide in the middle, pointed.

    Args:
        base: base of the right-hand one, in units of the head's length.
        tip: its tip.
        half_width: half of its greatest width.
        thick: half of its thickness.
        side: direction of the width.
        swivel: degrees of individual difference.
        pricked: widest at the base instead, as a cat's.
        chance: share of the individuals that have one.
    """
    outline = np.array((1.0, 0.95, 0.78, 0.5, 0.12) if pricked else (0.55, 0.88, 1.0, 0.72, 0.16))
    t = np.linspace(0, 1, 5)
    x, y, z = (a + (b - a) * t for a, b in zip(base, tip, strict=True))
    stations = Stations(x, y, thick * (1.15 - 0.4 * t), z, half_width * outline)
    return Ornament(stations, scale="ears", side=side, blend=0.015, swivel=swivel, chance=chance)


@dataclass(frozen=True)
class Eye(Table):
    """The right eye, placed on the surface of the skull.

    Args:
        x: along the head.
        angle: degrees above the middle of the side.
        radius: radius of the ball.
    """

    x: Number
    angle: Number
    radius: Number


@dataclass(frozen=True)
class Mouth(Table):
    """The groove between the lips.

    Args:
        x: position of its corner along the head.
        angle: degrees above the middle of the side, negative below.
    """

    x: Number
    angle: Number


@dataclass(frozen=True)
class Head(Table):
    """The skull and what grows on it, in the head's own frame and length: x to the nose, y up, 0 at the poll.

    Args:
        length: length of the head, in units of the height at the withers.
        pitch: degrees by which the face points up (negative: down) at rest.
        skull: its sections.
        eye: one eye of a pair.
        ornaments: nose, nostrils, ears, horns, in the order in which they blend.
        mouth: None for a closed one.
        flat: whether the snout ends flat.
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
        height: over the neck's spine, in neck radii.
        radius: its radius.
        half_width: half its width.
        aside: how far it falls to one side, in neck widths.
        bumps: their height; 0 for none.
    """

    height: Number
    radius: Number
    half_width: Number
    aside: Number = 0.0
    bumps: Number = 0.0


@dataclass(frozen=True)
class Quadruped(Table):
    """A kind of quadruped, standing at rest, head to +x, ground at y = 0, the withers about 1 high.

    Args:
        habits: the poses it takes; one named twice is drawn twice as often.
        torso: from the buttocks to the chest.
        neck: from inside the chest to the poll.
        head: the head.
        fore: the forelegs.
        hind: the hind legs.
        tail: from inside the croup to the tip.
        ornaments: humps and udders, in the body's frame.
        mane: or None.
        armour: plates, spikes or a frill, or None.
        ranges: ranges that replace entries of `_RANGES`.
        tail_lift: degrees between which the tail is raised.
        tail_ripple: bumps on the tail, or None.
        coat: bumps on torso and neck, or None.
        ruff: bumps on the neck, if they differ from the coat's.
        neck_pitch: degrees between which the neck is raised over its rest.
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
        """All poses and postures, common and rare; an armoured animal has only its habits."""
        return (*POSES, *POSTURES) if self.armour is None else tuple(dict.fromkeys(self.habits))

    def grow(self, pose: str | None, rng: Rng) -> list[Part]:
        """Return one individual's parts."""
        young = _YOUNG if rng.uniform() < _YOUNG_SHARE else None
        build = proportions(_RANGES, self.ranges, rng, young)
        drawn = drawn_pose(self.habits, pose, rng)
        return _assemble(self, build, (POSES[drawn] if drawn in POSES else POSTURES[drawn])(rng), rng)


def _assemble(species: Quadruped, build: _Build, pose: Pose, rng: Rng) -> list[Part]:
    """Return the parts, in the order in which they blend.

    Legs are united sharply among themselves, so that they do not melt into one another, and softly with
    the torso; ``rng`` draws only details: the swivel of ears, the presence of horns.
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
        rise = species.fore.y - hip[1] - up  # the straight forelegs then reach the ground
        reach = float(np.hypot(shoulder[0], shoulder[1]))
        angle = np.arcsin(min(rise / reach, 0.85)) - np.arctan2(shoulder[1], shoulder[0])
        turn = pitch(float(np.rad2deg(angle)))
    return Frame(hip + np.array([0.0, up, 0.0]) - turn @ hip, turn)


def _torso(species: Quadruped, build: _Build, body: Frame) -> Sweep:
    x, top, bottom = species.torso.x, species.torso.top, species.torso.bottom
    middle = np.sin(np.linspace(0, np.pi, len(x)))  # belly and waist change, breast and buttocks hardly
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
    """Return pitch of neck and head, in degrees, that bring the muzzle near the ground, by bisection."""
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
    # Seen from behind: what lifts a tail is a pitch downwards of the chain that runs backwards.
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
    """Return the height of the ground, 0 for legs of the drawn length."""
    return _BELOW_BELLY * (1 - build["legs"])


def _hang(limb: Limb, build: _Build, angles: tuple[float, ...]) -> Doubles:
    """Return the folded stations, (n + 1, 3), from the uppermost joint; the last one is the sole."""
    rows = limb.template.stations
    length = limb.y - _ground(build)
    forward = np.append(rows.x, rows.x[-1]) * length
    height = np.append(rows.y, 0.0)
    across = (limb.foot - limb.z) * (1 - height)
    points = np.column_stack([forward, (height - 1) * length, across])
    return fold(points, limb.template.joints, angles)


def _leg(limb: Limb, build: _Build, angles: tuple[float, ...], stance: bool, body: Frame) -> Sweep:
    """Return a right leg; a standing leg is stretched or shortened until its sole is on the ground."""
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
    """Return the flat muscle that runs from the point of the right shoulder up and back to the withers."""
    x, size, girth = limb.x * build["length"], limb.y * limb.thick, build["girth"]
    points = [
        [x, limb.y, limb.z * girth],
        [x - 0.07, limb.y + 0.14, (0.85 * limb.z + 0.01) * girth],
        [x - 0.13, limb.y + 0.25, 0.52 * limb.z * girth],
    ]
    radii, widths = np.array([0.13, 0.115, 0.075]) * size, np.array([0.085, 0.060, 0.040]) * size
    return tube(points, radii, widths).placed(body)


def _stretch(x: Doubles, muzzle: float) -> Doubles:
    """Return positions along the head with the face in front of the eyes stretched."""
    return x + (muzzle - 1) * np.maximum(x - _FACE, 0)


def _skull(head: Head, muzzle: float) -> Sweep:
    """Return the head without its ornaments, in its own frame and length."""
    sweep = replace(head.skull, x=_stretch(head.skull.x, muzzle)).sweep()
    return replace(sweep, cut=Cut(sweep.points[-1], np.array([1.0, 0.0, 0.0]))) if head.flat else sweep


def _ornament(
    item: Ornament, size: float, build: _Build, frame: Frame, rng: Rng, muzzle: float = 1.0
) -> Part:
    """Return an ornament, or a pair; its unit is ``size``, and ``muzzle`` stretches the face below it."""
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
    """Return a point (3,) on the right half of the skull, in units of its length, by its angle.

    The skull is the union of ellipsoids about all stations, so where it tapers steeply its surface lies
    outside the nearest station's section: the ray from the axis is cut with every ellipsoid near.
    Degrees are 0 to the side, 90 to the crown, -90 under the jaw.
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
    """Return eye sockets and perhaps the groove of the mouth, which are dug, and the eyeballs."""
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
    # The muzzle ends in half an ellipsoid as deep as it is high.
    ahead, up = np.cos(np.deg2rad(mouth.angle)), np.sin(np.deg2rad(mouth.angle))
    cap = np.array([end + _PROUD + rows.radius[-1] * ahead, rows.y[-1] + rows.radius[-1] * up, 0.0])
    bow = side[-1] * 0.3 + cap * 0.7 + np.array([0.0, 0.0, 0.25 * side[-1, 2]])
    return np.vstack([side, bow, cap])
