"""From species, build and pose to the parts of one quadruped."""

from dataclasses import dataclass, replace

import numpy as np

from normalgan.animals.chain import Frame, bend, pitch, yaw
from normalgan.animals.face import eyes, mouth
from normalgan.animals.field import Part
from normalgan.animals.head import loft, ornament, skull, stretch
from normalgan.animals.legs import ground, hang, leg, shoulder_blade
from normalgan.animals.pose import POSES, Pose
from normalgan.animals.species import Build, Ornament, Species, draw_build
from normalgan.animals.sweep import Floats, Sweep

SEATED = 0.82  # the back of an animal that sits is rounded, which brings shoulder and hip nearer
YOUNG_SHARE = 0.12


@dataclass(frozen=True)
class Quadruped:
    """The body plan of those that go on four legs.

    Args:
        species: its measures.
    """

    species: Species

    @property
    def poses(self) -> tuple[str, ...]:
        """Stand, walk, trot, gallop, graze and sit, whatever the species is mostly seen in."""
        return tuple(POSES)

    def grow(self, pose: str | None, rng: np.random.Generator) -> list[Part]:
        """Return one individual's parts."""
        build = draw_build(self.species.ranges, bool(rng.uniform() < YOUNG_SHARE), rng)
        drawn = str(rng.choice(self.species.poses))
        return assemble(self.species, build, POSES[pose or drawn](rng), rng)


def assemble(species: Species, build: Build, pose: Pose, rng: np.random.Generator) -> list[Part]:
    """Return the parts, in the order in which they blend.

    Legs are united sharply among themselves, so that they do not melt into one another, and softly with
    the torso; ``rng`` draws only small things: the swivel of ears, the presence of horns.
    """
    if pose.sit:
        build = replace(build, length=SEATED * build.length)
    body = _body(species, build, pose)
    torso = _torso(species, build, body)
    neck, head = _neck(species, build, pose, body)
    parts = [torso, neck, skull(species.head, build, head)]
    blades = [shoulder_blade(species.fore, build, body, right) for right in (True, False)]
    parts.append(Part(tuple(blades), blend=0.06))
    limbs = (species.fore, species.fore, species.hind, species.hind)
    parts.append(
        Part(
            tuple(
                leg(limb, build, angles, stance, body, right=i % 2 == 0)
                for i, (limb, angles, stance) in enumerate(zip(limbs, pose.legs, pose.stance, strict=True))
            ),
            blend=0.055,
        )
    )
    parts.append(_tail(species, build, pose, body))
    if species.mane is not None:
        parts.append(_crest(neck.sweeps[0], species.mane, 1.0 if rng.uniform() < 0.5 else -1.0))
    lips = mouth(species.head, build, head)
    parts += eyes(species.head, build, head) if lips is None else [*eyes(species.head, build, head), lips]
    parts += [ornament(item, 1.0, build, body, rng) for item in _chosen(species.ornaments, rng)]
    size = species.head.length * build.head
    for item in _chosen(species.head.ornaments, rng):
        parts.append(ornament(item, size, build, head, rng, build.muzzle))
    return parts


def _chosen(items: tuple[Ornament, ...], rng: np.random.Generator) -> list[Ornament]:
    chosen: list[Ornament] = []
    before = True
    for item in items:
        before = not before if item.otherwise else bool(rng.uniform() < item.chance)
        if before:
            chosen.append(item)
    return chosen


def _body(species: Species, build: Build, pose: Pose) -> Frame:
    hip = np.array([species.hind.x * build.length, species.hind.y, 0.0])
    turn, up = pitch(pose.pitch), 0.0
    if pose.sit:
        up = ground(build) - hang(species.hind, build, pose.legs[2])[-1, 1] - hip[1]
        shoulder = np.array([species.fore.x * build.length, species.fore.y, 0.0]) - hip
        rise = species.fore.y - hip[1] - up  # the straight forelegs then reach the ground
        reach = float(np.hypot(shoulder[0], shoulder[1]))
        turn = pitch(
            float(np.rad2deg(np.arcsin(min(rise / reach, 0.85)) - np.arctan2(shoulder[1], shoulder[0])))
        )
    return Frame(hip + np.array([0.0, up, 0.0]) - turn @ hip, turn)


def _torso(species: Species, build: Build, body: Frame) -> Part:
    rows = np.array(species.torso)
    rows[:, 0] *= build.length
    middle = np.sin(np.linspace(0, np.pi, len(rows)))  # belly and waist change, breast and buttocks hardly
    rows[:, 2] = rows[:, 1] - (rows[:, 1] - rows[:, 2]) * (1 + (build.depth - 1) * middle)
    rows[:, 3] *= build.girth
    points, radii, widths = loft(tuple(map(tuple, rows)))
    sides = np.tile(body.rotation[:, 2], (len(points), 1))
    return Part((Sweep(body.place(points), radii, widths, sides),), blend=0.0, ripple=species.coat)


def _neck(species: Species, build: Build, pose: Pose, body: Frame) -> tuple[Part, Frame]:
    rows = np.array(species.neck)
    points = np.column_stack([rows[:, :2], np.zeros(len(rows))])
    points[:, 0] += species.fore.x * (build.length - 1)
    points = points[0] + (points - points[0]) * build.neck
    low, high = species.neck_pitch
    up = low + (high - low) * pose.neck_pitch
    if pose.sit:
        up -= 0.6 * float(np.rad2deg(np.arcsin(body.rotation[1, 0])))
    angle = species.head.pitch + pose.head_pitch + 0.25 * up
    if pose.graze:
        up, angle = _lowered(species, build, points, body)
    moved, turns = bend(points, up, pose.neck_yaw)
    rotation = body.rotation @ yaw(pose.neck_yaw + pose.head_yaw) @ pitch(angle)
    if pose.sit:
        rotation = yaw(pose.neck_yaw + pose.head_yaw) @ pitch(angle)
    placed = body.place(moved)
    sides = (body.rotation @ turns)[:, :, 2]
    grow = np.linspace(1, build.head, len(rows)) * build.crest
    sweep = Sweep(placed, rows[:, 2] * grow, rows[:, 3] * grow, sides)
    return Part((sweep,), blend=0.12, ripple=species.ruff or species.coat), Frame(placed[-1], rotation)


def _lowered(species: Species, build: Build, points: Floats, body: Frame) -> tuple[float, float]:
    """Return pitch of neck and head, in degrees, that bring the muzzle near the ground, by bisection."""
    nose = np.array(species.head.rows[-1])
    tip = np.array([stretch(nose[:1], build.muzzle)[0], nose[2], 0.0]) * species.head.length * build.head

    def head_angle(up: float) -> float:
        return max(species.head.pitch + 0.35 * up, -72.0)

    high, low = 20.0, -170.0
    for _ in range(30):
        up = (high + low) / 2
        poll = bend(points, up, 0.0)[0][-1]
        clearance = body.place((poll + pitch(head_angle(up)) @ tip)[None])[0, 1] - ground(build)
        high, low = (up, low) if clearance > 0.03 else (high, up)
    return up, head_angle(up)


def _tail(species: Species, build: Build, pose: Pose, body: Frame) -> Part:
    rows = np.array(species.tail)
    points = np.column_stack([rows[:, :2], np.zeros(len(rows))])
    points[:, 0] *= build.length
    points = points[0] + (points - points[0]) * build.tail
    low, high = species.tail_lift
    # Seen from behind: what lifts a tail is a pitch downwards of the chain that runs backwards.
    moved, turns = bend(points, -(low + (high - low) * pose.tail_lift), pose.tail_swing)
    placed = body.place(moved)
    if pose.sit:
        placed[:, 1] = np.maximum(placed[:, 1], ground(build) + rows[:, 2])
    sides = (body.rotation @ turns)[:, :, 2]
    return Part((Sweep(placed, rows[:, 2], rows[:, 2], sides),), blend=0.03, ripple=species.tail_ripple)


def _crest(neck: Sweep, mane: tuple[float, float, float, float, float], sign: float) -> Part:
    height, radius, width, aside, bumps = mane
    tangents = np.gradient(neck.points, axis=0)
    dorsal = np.cross(neck.sides, tangents)
    dorsal /= np.linalg.norm(dorsal, axis=1, keepdims=True)
    points = neck.points + dorsal * (neck.radii * height)[:, None]
    points += neck.sides * (neck.widths * aside * sign)[:, None]
    count = len(points)
    ripple = (bumps, 0.06) if bumps else None
    return Part(
        (Sweep(points, np.full(count, radius), np.full(count, width), neck.sides),), 0.01, ripple=ripple
    )
