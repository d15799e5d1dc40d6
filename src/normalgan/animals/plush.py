"""Plush toys, one function each: a round body, stubby limbs, a large head, and sometimes seams."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from normalgan.animals.frames import Frame, pitch, ray, roll, unit, yaw
from normalgan.animals.insects import wing
from normalgan.animals.parts import Part, ball, block, by, carried, fuse, in_space, pair, tube
from normalgan.animals.plan import BodyPlan, FunctionPlan, Rng, around
from normalgan.animals.shapes import Shape, Sweep
from normalgan.animals.tables import Point
from normalgan.arrays import Doubles

_HABITS = ("sit", "sit", "stand", "hug", "cheer")
_SKULL = np.array([1.0, 0.93, 1.08])  # radii of a head in its own unit
# Outline of a dragon's right wing: outwards, forward.
_BAT = np.array([(-0.05, 0.03), (0.16, 0.16), (0.40, 0.14), (0.36, -0.02), (0.26, -0.04), (0.2, -0.13),
                 (0.1, -0.1), (0.0, -0.12)])  # fmt: skip


def _sewn(
    features: list[Part],
    pose: str,
    rng: Rng,
    belly: Point = (0.25, 0.30, 0.26),
    head: float = 0.27,
    limbs: float = 1.0,
    arms: float = 1.0,
    hands: bool = False,
) -> list[Part]:
    """Return a toy about 1 high, with its seat or soles at about y = 0.

    Args:
        features: parts of the head, in units of half its height.
        pose: one of `_HABITS`; hugging and cheering toys sit or stand.
        rng: source of randomness for proportions, positions of the limbs and seams.
        belly: radii of the body.
        head: half of the head's height.
        limbs: relative thickness of arms and legs.
        arms: relative length of the arms.
        hands: whether the hands are thicker than the arms.
    """
    stout, tall, size, fat, long = around(rng, 0.12, 1.0, 1.0, head, 1.0, 1.0)
    radii = np.array(belly) * [stout, tall, stout]
    depth, half, width = radii
    sits = pose == "sit" or (pose != "stand" and rng.uniform() < 0.6)
    thick = 0.10 * limbs * fat
    parts = [fuse(ball((0, half), radii))]
    parts.append(pair(*_leg(depth, half, width, thick, sits, rng), blend=0.025))
    right, left = (_arm(radii, 0.85 * thick, arms, long, hands, pose, rng) for _ in range(2))
    parts.append(fuse(*right, *(shape.mirrored() for shape in left), blend=0.025))
    nod = yaw(rng.normal(0, 12)) @ pitch(rng.uniform(-10, 8))
    chin = Frame(np.array([0.12 * depth, 2 * half + 0.68 * size, 0]), nod)
    if rng.uniform() < 0.45:
        parts.append(fuse(_seam((0, half), radii), blend=0.01, carve=True))
        features = [*features[:1], fuse(_seam((0, 0), _SKULL), blend=0.03, carve=True), *features[1:]]
    return parts + carried(features, chin, size)


def _seam(at: ArrayLike, radii: ArrayLike) -> Sweep:
    """Return the line along the middle of an ellipsoid, to be carved."""
    turns = np.linspace(-0.42, 0.62, 17) * np.pi
    ring = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    return tube(in_space(at) + 1.01 * ring * np.array(radii, float), 0.008)


def _on_skull(aside: float, up: float, out: float = 1.0) -> Doubles:
    """Return the point (3,) on the head ``aside`` degrees right of and ``up`` degrees above its middle."""
    way = ray(np.deg2rad(aside), np.deg2rad(up))
    return way / float(np.linalg.norm(way / _SKULL)) * out


def _skull(cheeks: float = 0.0) -> list[Part]:
    """Return the bare head with cheeks of a given size."""
    parts = [fuse(ball((0, 0), _SKULL), blend=0.05)]
    if cheeks:
        parts.append(pair(ball([0.35, -0.35, 0.55], cheeks), blend=0.3))
    return parts


def _buttons(aside: float, up: float, radius: float) -> Part:
    """Return a pair of round button eyes."""
    return pair(ball(_on_skull(aside, up, 1.0), radius), blend=0.02)


def _smile(aside: float, up: float, rise: float, out: float = 1.0) -> Part:
    """Return the groove of a mouth, to be carved, with corners ``rise`` degrees above its middle."""
    t = np.linspace(-1, 1, 9)
    curve = [_on_skull(aside * float(s), up + rise * float(s * s), out) for s in t]
    return fuse(tube(curve, 0.03), blend=0.02, carve=True)


def _leg(depth: float, half: float, width: float, thick: float, sits: bool, rng: Rng) -> list[Shape]:
    spread = rng.uniform(12, 34)
    if not sits:
        hip, sole = np.array([0.0, 0.35 * half, 0.52 * width]), np.array([0.02, -0.16, 0.60 * width])
        foot = ball(by(sole, 0.05, -0.01, 0.0), [1.6 * thick, thick, 1.2 * thick])
        return [tube([hip, sole], [1.2 * thick, 1.1 * thick]), foot]
    ahead = yaw(-spread) @ np.array([0.85 * depth + rng.uniform(0.10, 0.18), 0.0, 0.0])
    sole = np.array([0.0, 1.05 * thick, 0.5 * width]) + ahead
    shank = tube([[0.1 * depth, 1.05 * thick, 0.5 * width], sole], [1.15 * thick, 1.05 * thick])
    foot = ball(by(sole, 0.02, 0.35 * thick, 0), [0.75 * thick, 1.45 * thick, 1.15 * thick], yaw(-spread))
    return [shank, foot]


def _arm(
    belly: Doubles, thick: float, arms: float, long: float, hands: bool, pose: str, rng: Rng
) -> list[Shape]:
    shoulder = belly * [0.05, 1.62, 0.66]
    jitter = rng.uniform(-0.05, 0.05, 3)
    way = {"hug": [0.30, -0.02, 0.06], "cheer": [0.04, 0.20, 0.24]}.get(pose, [0.12, -0.20, 0.17])
    hand = shoulder + (np.array(way) + jitter) * arms * long * 1.12
    elbow = by((shoulder + hand) / 2, 0, 0, 0.015)
    arm = tube([shoulder, elbow, hand], [1.1 * thick, 1.05 * thick, thick])
    return [arm, ball(hand, 1.25 * thick)] if hands else [arm]


def _teddy(pose: str, rng: Rng) -> list[Part]:
    """Return a teddy bear."""
    ear, muzzle = rng.uniform(0.34, 0.46), rng.uniform(0.85, 1.15)
    face = [
        *_skull(),
        fuse(ball((0.82, -0.26), np.array([0.42, 0.34, 0.42]) * muzzle), blend=0.12),
        fuse(ball((0.84 + 0.40 * muzzle, -0.12), [0.09, 0.10, 0.15]), blend=0.02),
        fuse(tube([(1.24 * muzzle, -0.22), (1.18 * muzzle, -0.42)], 0.03), blend=0.02, carve=True),
        _buttons(26, 16, 0.10),
        pair(ball([0.0, 0.80, 0.72], [0.17, ear, ear]), blend=0.08),
        pair(ball([0.15, 0.84, 0.76], [0.14, 0.6 * ear, 0.6 * ear]), blend=0.06, carve=True),
    ]
    body = _sewn(face, pose, rng, hands=True)
    return [*body, fuse(ball((-0.24, 0.10), rng.uniform(0.06, 0.09)), blend=0.03)]


def _bunny(pose: str, rng: Rng) -> list[Part]:
    """Return a bunny, sometimes with a floppy ear."""
    long = rng.uniform(1.0, 1.6)
    flop = [rng.uniform() < 0.3 for _ in range(2)]
    ears = []
    for sign, bent in zip((1.0, -1.0), flop, strict=True):
        rows = [[-0.05, 0.7, 0.34 * sign], [-0.1, 0.8 + 0.5 * long, 0.46 * sign]]
        if bent:
            rows += [[0.05, 0.85 + 0.72 * long, 0.75 * sign], [0.3, 0.7 + 0.45 * long, 1.1 * sign]]
        else:
            rows += [[-0.15, 0.8 + long, 0.6 * sign]]
        ears.append(tube(rows, 0.12, [0.2, 0.3, 0.26, 0.16][: len(rows)]))
    face = [
        *_skull(0.32),
        fuse(ball((0.92, -0.25), [0.22, 0.2, 0.3]), blend=0.12),
        fuse(ball((1.12, -0.12), [0.07, 0.07, 0.11]), blend=0.02),
        _buttons(30, 12, 0.10),
        fuse(*ears, blend=0.06),
    ]
    tail = ball((-0.27, 0.13), rng.uniform(0.09, 0.13))
    return [*_sewn(face, pose, rng, belly=(0.24, 0.31, 0.25), limbs=0.95), fuse(tail, blend=0.02)]


def _cat(pose: str, rng: Rng) -> list[Part]:
    """Return a cat with pointed ears and a long tail."""
    ear = rng.uniform(0.9, 1.2)
    prick = tube([[-0.02, 0.55, 0.52], [-0.05, 0.55 + 0.72 * ear, 0.80]], [0.16, 0.05], [0.42, 0.05])
    face = [
        *_skull(0.3),
        pair(ball([0.95, -0.28, 0.13], [0.16, 0.15, 0.19]), blend=0.05),
        fuse(ball((1.08, -0.14), [0.06, 0.06, 0.09]), blend=0.02),
        _buttons(30, 14, 0.115),
        pair(prick, blend=0.06),
        pair(ball([0.16, 0.86, 0.66], [0.13, 0.26, 0.17], roll(-20)), blend=0.05, carve=True),
    ]
    up, aside = rng.uniform(0.1, 0.5), float(rng.choice((-1, 1)))
    tail = np.array(
        [[-0.15, 0.12, 0], [-0.38, 0.11, 0.08], [-0.48, 0.2 + 0.5 * up, 0.16], [-0.40, 0.25 + up, 0.2]]
    )
    body = _sewn(face, pose, rng, belly=(0.23, 0.29, 0.23))
    return [*body, fuse(tube(tail * [1, 1, aside], 0.062), blend=0.03)]


def _pig(pose: str, rng: Rng) -> list[Part]:
    """Return a pig: a flat snout, folded ears, a curl."""
    wide = rng.uniform(0.38, 0.48)
    fold = rng.uniform(0.2, 0.5)
    ear = tube([[0.02, 0.58, 0.56], [0.2 + 0.35 * fold, 1.12 - 0.3 * fold, 0.84]], [0.15, 0.05], [0.42, 0.05])
    snout = tube([(0.7, -0.12), (1.22, -0.12)], [0.9 * wide, 0.85 * wide], [1.1 * wide, wide])
    flat = block((1.62, -0.12), [0.4, 0.48, 0.5], 0.05)  # cuts the snout flat, but not arms that hug
    face = [
        *_skull(0.3),
        fuse(snout, blend=0.06),
        fuse(flat, carve=True),
        pair(ball([1.24, -0.12, 0.42 * wide], [0.12, 0.3 * wide, 0.2 * wide]), blend=0.03, carve=True),
        _smile(22, -38, 9),
        _buttons(34, 22, 0.09),
        pair(ear, blend=0.05),
    ]
    turn = np.linspace(0, 3.2 * np.pi, 14)
    curl = np.column_stack([-0.22 - 0.011 * turn, 0.27 + 0.05 * np.sin(turn), 0.05 * np.cos(turn) - 0.05])
    body = _sewn(face, pose, rng, belly=(0.28, 0.29, 0.29), head=0.26)
    return [*body, fuse(tube(curl, 0.022), blend=0.01)]


def _frog(pose: str, rng: Rng) -> list[Part]:
    """Return a frog: eyes on top, a mouth from ear to ear."""
    size = rng.uniform(0.30, 0.40)
    face = [
        fuse(ball((0, 0), [0.98, 0.78, 1.15]), blend=0.05),
        pair(ball([0.30, 0.66, 0.55], size), blend=0.08),
        pair(ball([0.30 + 0.8 * size, 0.72, 0.62], 0.42 * size), blend=0.02),
        _smile(62, -10, 12, 0.955),
    ]
    belly = (0.26, 0.25, 0.28)
    return _sewn(face, pose, rng, belly, head=0.29, limbs=0.85, arms=1.15, hands=True)


def _elephant(pose: str, rng: Rng) -> list[Part]:
    """Return an elephant: a trunk, large ears, sometimes tusks."""
    ear, lift = rng.uniform(0.85, 1.2), rng.uniform(0.0, 1.0)
    trunk = [(0.75, -0.1), (1.25, -0.35), (1.45, -0.85 + 0.4 * lift), (1.75, -1.0 + 0.9 * lift),
             (1.98, -0.9 + 1.25 * lift)]  # fmt: skip
    flap = ball([-0.1, 0.12, 1.0 + 0.55 * ear], np.array([0.15, 0.80, 0.72]) * ear, yaw(-22) @ roll(12))
    hollow = ball([0.10, 0.08, 1.02 + 0.6 * ear], np.array([0.13, 0.5, 0.45]) * ear, yaw(-22))
    face = [
        *_skull(),
        fuse(tube(trunk, [0.36, 0.28, 0.21, 0.17, 0.16]), blend=0.12),
        _buttons(36, 16, 0.09),
        pair(flap, blend=0.10),
        pair(hollow, blend=0.1, carve=True),
    ]
    if rng.uniform() < 0.5:
        tusk = tube([[0.75, -0.42, 0.34], [1.1, -0.6, 0.40], [1.3, -0.5, 0.38]], [0.12, 0.09, 0.04])
        face.append(pair(tusk, blend=0.03))
    tail = tube([[-0.2, 0.22, 0], [-0.36, 0.2, 0.02], [-0.44, 0.06, 0.03]], [0.035, 0.028, 0.04])
    body = _sewn(face, pose, rng, belly=(0.29, 0.31, 0.29), limbs=1.25)
    return [*body, fuse(tail, blend=0.02)]


def _penguin(pose: str, rng: Rng) -> list[Part]:
    """Return a penguin: an egg with a beak, flippers and flat feet."""
    fat, tall, head, far, long = around(rng, 0.14, 0.30, 0.42, 0.26, 0.14, 0.44)
    middle = 2 * tall + 0.35 * head
    out = {"cheer": 62.0, "hug": 24.0}.get(pose, rng.uniform(12, 34))
    turn = roll(out) @ pitch(40.0 if pose == "hug" else 0.0)
    shoulder = np.array([0.0, 1.5 * tall, 0.68 * fat])
    rows = np.array([[0, 0.04, 0], [0, -0.5 * long, 0.02], [-0.03, -long, 0.0]]) @ turn.T + shoulder
    flipper = tube(rows, [0.045, 0.05, 0.03], [0.11, 0.12, 0.05], turn @ [1.0, 0, 0])
    nose = 0.06 + 0.95 * head
    beak = tube([(nose - 0.08, middle), (nose + far, middle - 0.03)], [0.085, 0.015], [0.10, 0.02])
    foot = ball([0.13, 0.02, 0.14], [0.17, 0.045, 0.11], yaw(-18))
    if pose == "sit":
        foot = ball([0.86 * fat, 0.11, 0.15], [0.06, 0.15, 0.11], yaw(-18))
    tail = tube([(-0.8 * fat, 0.25 * tall), (-1.12 * fat, 0.08 * tall)], [0.08, 0.03], [0.11, 0.06])
    parts = [
        fuse(ball((0, tall), [0.92 * fat, tall, fat])),
        fuse(ball((0.03, middle), [head, 0.95 * head, 1.02 * head]), blend=0.09),
        fuse(ball((0.12 * fat, 0.92 * tall), [0.88 * fat, 0.8 * tall, 0.80 * fat]), blend=0.008),
        pair(flipper, blend=0.03),
        fuse(beak, blend=0.015),
        pair(ball([0.06 + 0.82 * head, middle + 0.30 * head, 0.47 * head], 0.032), blend=0.006),
        pair(foot, blend=0.015),
        fuse(tail, blend=0.05),
    ]
    if rng.uniform() < 0.4:  # a cap with a bobble
        cap = ball((-0.01, middle + 0.85 * head), [0.8 * head, 0.5 * head, 0.8 * head])
        parts += [fuse(cap, blend=0.01), fuse(ball((-0.02, middle + 1.45 * head), 0.32 * head), blend=0.01)]
    return parts


def _octopus(pose: str, rng: Rng) -> list[Part]:
    """Return an octopus: a bulb on eight arms that end in curls."""
    tall, wide, reach = around(rng, 0.14, 0.42, 0.36, 0.50)
    thick = rng.uniform(0.075, 0.10)
    raised = {"cheer": 0.30, "hug": 0.14}.get(pose, 0.0)
    arms = []
    for i in range(8):
        turn = yaw(22.5 + 45 * i + rng.normal(0, 5))
        curl = rng.uniform(0.02, 0.16) + raised * rng.uniform(0.5, 1.2)
        side = float(rng.choice((-1, 1))) * rng.uniform(0.0, 0.14)
        rows = [
            [0.1, 0.22, 0],
            [0.28, 0.10, 0],
            [0.28 + 0.55 * reach, thick, side],
            [0.28 + reach, thick + 0.4 * curl, 1.6 * side],
            [0.22 + reach, thick + 1.2 * curl, 2.2 * side],
        ]
        arms.append(tube(np.array(rows) @ turn.T, np.array([1.2, 1.1, 0.9, 0.7, 0.5]) * thick))
    eye = np.array([0.80 * wide, 0.32 + 0.62 * tall, 0.42 * wide])
    a = np.linspace(-0.35, 0.35, 7)
    mouth = [0.93 * wide * np.cos(a), 0.30 + 0.32 * tall + 0.05 * a * a, 0.93 * wide * np.sin(a)]
    return [
        fuse(ball((-0.02, 0.28 + tall), [wide, tall, 1.02 * wide])),
        fuse(ball((0, 0.24), [0.30, 0.20, 0.30]), blend=0.15),
        fuse(*arms, blend=0.06),
        pair(ball(eye, 0.085), blend=0.02),
        pair(ball(by(eye, 0.07, 0.01, 0.01), 0.04), blend=0.006),
        fuse(tube(np.column_stack(mouth), 0.014), blend=0.012, carve=True),
    ]


def _dragon(pose: str, rng: Rng) -> list[Part]:
    """Return a dragon: snout, horns, a comb down the back, small wings, a tail with a barb."""
    horn, snout = rng.uniform(0.5, 0.95), rng.uniform(0.85, 1.15)
    jaws = tube([(0.5, -0.25), (0.6 + 0.62 * snout, -0.28)], [0.46, 0.36], [0.52, 0.46])
    horns = [[-0.15, 0.72, 0.42], [-0.35, 0.95 + 0.5 * horn, 0.55], [-0.40, 1.0 + horn, 0.5]]
    ear = tube([[-0.1, 0.25, 0.95], [-0.3, 0.4, 1.45]], [0.08, 0.03], [0.26, 0.03], [0, 1, 0])
    face = [
        *_skull(0.2),
        fuse(jaws, blend=0.12),
        pair(ball([0.78 + 0.72 * snout, -0.02, 0.2], 0.12), blend=0.06),
        pair(ball([0.93 + 0.72 * snout, 0.02, 0.21], 0.06), blend=0.03, carve=True),
        _buttons(34, 24, 0.15),
        pair(tube(horns, [0.17, 0.11, 0.03]), blend=0.06),
        pair(ear, blend=0.05),
    ]
    for k in (0.35, 0.9):  # the comb's first two teeth
        tooth = [(-0.55 * k, 0.95 - 0.35 * k), (-0.75 * k - 0.12, 1.35 - 0.5 * k)]
        face.append(fuse(tube(tooth, [0.2, 0.03], 0.09), blend=0.03))
    parts = _sewn(face, pose, rng, belly=(0.26, 0.30, 0.26), head=0.25, limbs=0.95)
    aside = float(rng.choice((-1, 1)))
    tail = np.array([[-0.1, 0.16, 0], [-0.34, 0.10, 0.02], [-0.55, 0.09, 0.10], [-0.70, 0.13, 0.24]])
    tail = tail * [1, 1, aside]
    way = unit(tail[-1] - tail[-2])
    barb = tube([tail[-1], tail[-1] + 0.14 * way], [0.03, 0.025], [0.1, 0.02], [0, 1, 0])
    comb = []
    for i in range(5):
        out = ray(0.0, np.deg2rad(110 + 28 * i))
        at = np.array([0.0, 0.30, 0]) + out * [0.22, 0.27, 0]
        comb.append(tube([at, at + 0.15 * out], [0.07, 0.012], 0.035))
    parts += [
        fuse(tube(tail, [0.16, 0.12, 0.075, 0.04]), blend=0.06),
        fuse(barb, blend=0.01),
        fuse(*comb, blend=0.02),
    ]
    span = rng.uniform(0.8, 1.2)
    web = wing([0, 0, 0], _BAT * span, rng.uniform(15, 50), 0.0, 0.02)
    return [*parts, *carried([fuse(*web, blend=0.02)], Frame(np.array([-0.20, 0.44, 0.0]), pitch(62)))]


PLUSH: Mapping[str, BodyPlan] = {
    "plush_bunny": FunctionPlan(_HABITS, _bunny),
    "plush_cat": FunctionPlan(_HABITS, _cat),
    "plush_dragon": FunctionPlan(_HABITS, _dragon),
    "plush_elephant": FunctionPlan(_HABITS, _elephant),
    "plush_frog": FunctionPlan(_HABITS, _frog),
    "plush_octopus": FunctionPlan(_HABITS, _octopus),
    "plush_penguin": FunctionPlan(_HABITS, _penguin),
    "plush_pig": FunctionPlan(_HABITS, _pig),
    "teddy": FunctionPlan(_HABITS, _teddy),
}
