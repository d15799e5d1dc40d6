"""Insects and other arthropods, one function each, and their parts: jointed legs, rings, wings."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from normalgan.animals.frames import Frame, hinge, pitch, ray, roll, yaw
from normalgan.animals.parts import Part, Ripple, ball, both, by, carried, fuse, in_space, on_side, pair, tube
from normalgan.animals.plan import BodyPlan, FunctionPlan, Rng, around
from normalgan.animals.shapes import Plate, Shape, Sweep
from normalgan.animals.tables import Span
from normalgan.arrays import Doubles

_OUT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # columns: right, forward, up
# Outlines of right wings: outwards, forward.
_BLADE = np.array(
    [(-0.03, 0.02), (0.2, 0.07), (0.5, 0.07), (0.66, -0.02), (0.58, -0.14), (0.3, -0.16), (0.05, -0.06)]
)
_LONG = np.array(
    [(-0.04, 0.02), (0.3, 0.05), (0.75, 0.06), (0.92, 0.0), (0.8, -0.09), (0.35, -0.1), (0.05, -0.05)]
)
_FORE = np.array(
    [(-0.04, 0.02), (0.35, 0.32), (0.72, 0.48), (0.80, 0.36), (0.66, 0.06), (0.4, -0.10), (0.08, -0.08)]
)
_HIND = np.array(
    [(-0.04, 0.05), (0.35, 0.06), (0.56, -0.10), (0.54, -0.36), (0.34, -0.52), (0.14, -0.40), (0.03, -0.12)]
)


class LegRow(NamedTuple):
    """Position and direction of a pair of legs.

    Args:
        x: position along the body.
        z: half of the distance between the roots of the legs.
        azimuth: angle from straight ahead, in degrees.
        reach: distance of the feet from the roots.
    """

    x: float
    z: float
    azimuth: float
    reach: float


def legs(
    rows: Sequence[LegRow],
    pose: str,
    rng: Rng,
    ground: float,
    thick: float,
    bent: float = 1.25,
    at: float = 0.0,
) -> Part:
    """Return jointed legs: femur up and out, tibia down, a foot.

    Walking legs form tripods, where neighbours swing alternately (Wilson, "Insect walking", 1966). In
    flight, legs hang down.

    Args:
        rows: pairs of legs from front to back.
        pose: walk, fly, or any other pose.
        rng: source of randomness for the swing.
        ground: distance of the ground below the body's axis.
        thick: radius of the femur.
        bent: ratio of a leg's length to the distance between its ends.
        at: height of the roots.
    """
    swing = rng.uniform(9, 17) * (1 if rng.uniform() < 0.5 else -1)
    shapes: list[Shape] = []
    for i, (x, z, azimuth, reach) in enumerate(rows):
        for side in (0, 1):
            phase = 1 if (i + side) % 2 else -1
            angle = azimuth + rng.uniform(-4, 4) + (phase * swing if pose == "walk" else 0.0)
            lift = 0.22 * ground if pose == "walk" and phase * swing > 0 else 0.0
            far, low = (0.55 * reach, 0.9 * ground) if pose == "fly" else (reach, ground - lift)
            away = ray(np.deg2rad(angle), 0.0)
            hip = np.array([x, at, z])
            foot = hip + far * away
            foot[1] = -low
            length = bent * float(np.linalg.norm(foot - hip))
            knee = hinge(hip, foot, 0.46 * length, 0.54 * length, (0.0, 1.0, 0.0))
            leg = _leg(hip, knee, foot, foot + 0.16 * far * away, thick)
            shapes.append(on_side(leg, side == 0))
    return fuse(*shapes, blend=0.6 * thick)


def _leg(hip: Doubles, knee: Doubles, foot: Doubles, toe: Doubles, thick: float) -> Sweep:
    inner = hip * np.array([1.0, 1.0, 0.4])
    points = [inner, hip, (hip + knee) / 2, knee, (knee + foot) / 2, foot, toe]
    return tube(points, np.array([1.1, 1.05, 1.15, 0.85, 0.7, 0.55, 0.5]) * thick)


def _feelers(base: ArrayLike, bends: Sequence[ArrayLike], thick: float, club: float = 0.8) -> Part:
    """Return a pair of antennae.

    Args:
        base: base of the right antenna.
        bends: further points of the antenna, relative to the base.
        thick: radius at the base.
        club: ratio of the radius at the tip to that at the base.
    """
    start = np.array(base, float)
    points = [start, *(start + np.array(step, float) for step in bends)]
    radii = np.linspace(1, 0.8, len(points)) * thick
    radii[-1] = club * thick
    return pair(tube(points, radii), blend=0.01)


def _eyes(at: ArrayLike, radii: ArrayLike, turn: float = 0.0) -> Part:
    """Return a pair of compound eyes, without facets."""
    return pair(ball(at, radii, yaw(turn)), blend=0.01)


def _ringed(points: ArrayLike, radii: ArrayLike, rings: int, depth: float, flat: float = 1.0) -> Sweep:
    """Return a tube with rings, between which the radius is smaller by a fraction ``depth``.

    Args:
        points: stations of the curve.
        radii: radii at the stations.
        rings: number of rings.
        depth: depth of the grooves relative to the radius, from 0 to 1.
        flat: ratio of width to height.
    """
    from scipy.interpolate import CubicSpline  # slow to import, only needed for insects

    stations, sizes = in_space(points), np.array(radii, float)
    knots = np.linspace(0, 1, len(stations))
    at = np.linspace(0, 1, 4 * rings + 1)
    curve = CubicSpline(knots, np.column_stack([stations, sizes]))(at)
    fat = np.maximum(curve[:, 3], 0.02) * (1 - depth * np.abs(np.cos(np.pi * rings * at)) ** 3)
    return tube(curve[:, :3], fat, fat * flat)


def wing(
    hinge_at: ArrayLike, outline: ArrayLike, raised: float, back: float, thick: float, bow: float = 0.0
) -> tuple[Shape, ...]:
    """Return a pair of wings.

    Args:
        hinge_at: position of the right wing's hinge.
        outline: corners (outwards, forward) of a smooth outline with the hinge at the origin.
        raised: angle above the horizontal in degrees; 90 is straight up.
        back: backward sweep in degrees.
        thick: half thickness.
        bow: curvature across the wing; positive values arch it upwards.
    """
    from scipy.interpolate import CubicSpline

    corners = np.array(outline, float)
    corners = np.vstack([corners, corners[:1]])
    at = np.linspace(0, len(corners) - 1, 6 * len(corners) - 5)[:-1]
    smooth = CubicSpline(np.arange(len(corners)), corners, bc_type="periodic")(at)
    frame = Frame(np.array(hinge_at, float), roll(raised) @ yaw(-back) @ _OUT)
    return both(Plate(frame, smooth, thick, bow=(-bow, -bow)))


def _held(rng: Rng, raised: Span, back: Span) -> tuple[float, float]:
    """Return random angles by which wings are raised and swept back, in degrees."""
    return rng.uniform(*raised), rng.uniform(*back)


def _beetle(pose: str, rng: Rng) -> list[Part]:
    """Return a beetle: wing cases with a seam, a shield, and sometimes jaws or a horn."""
    long, wide, high, reach = around(rng, 0.15, 0.40, 0.25, 0.19, 1.0)
    front = -0.12 + long
    nose = front + 0.20
    x = np.linspace(-0.93, 0.8, 12)
    seam = np.column_stack([-0.14 + long * x, 0.02 + high * np.sqrt(1 - x * x) + 0.008])
    rows = (
        LegRow(front - 0.08, 0.6 * wide, 42, 0.36 * reach),
        LegRow(-0.10, 0.7 * wide, 92, 0.38 * reach),
        LegRow(-0.24, 0.6 * wide, 138, 0.42 * reach),
    )
    parts = [
        fuse(ball((-0.14, 0.02), [long, high, wide])),
        fuse(tube(seam, 0.014), blend=0.01, carve=True),
        fuse(ball((front - 0.03, 0.01), [0.16, 0.82 * high, 0.82 * wide]), blend=0.008),
        fuse(ball((front + 0.14, -0.02), [0.10, 0.09, 0.115]), blend=0.015),
        _eyes([front + 0.17, 0.0, 0.10], 0.034),
        legs(rows, pose, rng, 0.20, 0.032, 1.22, -0.07),
    ]
    if rng.uniform() < 0.5:  # a groove along each wing case
        x = np.linspace(-0.85, 0.75, 12)
        arch = np.sqrt(1 - x * x)
        line = [-0.14 + 0.9 * long * x, 0.02 + 0.995 * high * arch * 0.85, 0.53 * wide * arch]
        parts.append(pair(tube(np.column_stack(line), 0.01), blend=0.01, carve=True))
    kind = str(rng.choice(("plain", "stag", "horn")))
    if kind == "stag":
        jaw = [[0, -0.03, 0.05], [0.13, -0.02, 0.15], [0.30, 0.02, 0.14], [0.38, 0.03, 0.03]]
        prong = [[nose + 0.2, 0.0, 0.15], [nose + 0.24, 0.0, 0.06]]
        jaws = tube(np.array([nose, 0, 0]) + jaw, [0.045, 0.038, 0.03, 0.018])
        parts.append(pair(jaws, tube(prong, [0.03, 0.015]), blend=0.01))
    elif kind == "horn":
        tip = rng.uniform(0.22, 0.36)
        horn = [(nose - 0.08, 0.0), (nose + 0.05, 0.10), (nose + 0.09, 0.7 * tip), (nose, tip)]
        parts.append(fuse(tube(horn, [0.06, 0.045, 0.035, 0.016]), blend=0.02))
    ends = [[0.10, 0.05, 0.10], [0.16, 0.05, 0.22]]
    return [*parts, _feelers([nose - 0.02, 0.02, 0.06], ends, 0.017, club=1.6)]


def _ladybird(pose: str, rng: Rng) -> list[Part]:
    """Return a ladybird: a dome with slightly raised spots."""
    long, high, reach, spot = around(rng, 0.1, 0.42, 0.30, 0.30, 1.0)
    wide = 0.37
    radii = np.array([long, high, wide])
    x = np.linspace(-0.95, 0.72, 14)
    seam = np.column_stack([long * x, high * np.sqrt(1 - x * x) + 0.006])
    neck = 0.88 * long
    spots = []
    for along, aside in ((0.42, 0.40), (-0.05, 0.60), (-0.52, 0.42), (-0.02, 0.24)):
        up = np.array([along, 0.0, aside])
        up[1] = np.sqrt(1 - up @ up)
        across, ahead = np.rad2deg(np.arctan2(up[[2, 0]] / [wide, long], up[1] / high))
        lie = roll(-across) @ pitch(-ahead)
        spots.append(ball(up * radii, np.array([0.085, 0.016, 0.085]) * spot, lie))
    rows = (LegRow(0.28, 0.22, 40, reach), LegRow(0.0, 0.27, 92, reach), LegRow(-0.22, 0.22, 140, reach))
    return [
        fuse(ball((0, 0), radii)),
        fuse(tube(seam, 0.014), blend=0.01, carve=True),
        fuse(ball((neck, 0.03), [0.15, 0.17, 0.24]), blend=0.008),
        fuse(ball((neck + 0.13, -0.01), [0.09, 0.10, 0.13]), blend=0.01),
        _eyes([neck + 0.16, 0.02, 0.105], 0.04),
        _feelers([neck + 0.19, 0.04, 0.05], [[0.07, 0.06, 0.05], [0.14, 0.07, 0.11]], 0.016, club=1.5),
        pair(*spots, blend=0.012),
        legs(rows, pose, rng, 0.24, 0.030, 1.15, -0.1),
    ]


def _ant(pose: str, rng: Rng) -> list[Part]:
    """Return an ant: three beads, a waist, elbowed antennae."""
    gaster, size, reach, thorax = around(rng, 0.15, 0.17, 1.0, 1.0, 1.0)
    tip = rng.uniform(-0.05, 0.08)
    head = 0.135 * size
    nose = 0.20 + head
    breast = tube([(-0.14, 0.0), (0.02, 0.02), (0.17, 0.05)], np.array([0.05, 0.085, 0.075]) * thorax)
    waist = tube([(-0.30, -0.01), (-0.22, 0.05), (-0.12, 0.0)], [0.03, 0.05, 0.04])
    jaw = [[nose + 0.07, -0.02, 0.06], [nose + 0.17, -0.06, 0.07], [nose + 0.20, -0.08, 0.015]]
    elbows = [[0.10, 0.16, 0.09], [0.27, 0.13, 0.15], [0.38, 0.05, 0.18]]
    rows = (
        LegRow(0.14, 0.055, 48, 0.42 * reach),
        LegRow(0.05, 0.06, 95, 0.44 * reach),
        LegRow(-0.05, 0.055, 142, 0.5 * reach),
    )
    return [
        fuse(breast),
        fuse(waist, blend=0.03),
        fuse(ball((-0.26 - 1.25 * gaster, tip), [1.3 * gaster, gaster, gaster], pitch(-12)), blend=0.03),
        fuse(ball((nose, 0.05), [head * 1.12, 0.78 * head, head], pitch(-30)), blend=0.04),
        pair(tube(jaw, [0.035, 0.028, 0.016]), blend=0.01),
        _eyes([nose + 0.03, 0.09, 0.085 * size], [0.032, 0.03, 0.026]),
        _feelers([nose + 0.08, 0.07, 0.04], elbows, 0.02),
        legs(rows, pose, rng, 0.24, 0.027, 1.3),
    ]


def _caterpillar(pose: str, rng: Rng) -> list[Part]:
    """Return a caterpillar: rings on stumpy legs, with an arched back if it walks."""
    rings = int(rng.integers(8, 12))
    arch = rng.uniform(0.16, 0.30) if pose == "walk" else rng.uniform(0.0, 0.05)
    fat, sway = rng.uniform(0.085, 0.115), rng.uniform(-0.1, 0.1)
    x = np.linspace(-0.6, 0.6, rings)
    y = arch * np.cos(np.pi * x / 1.2) ** 2 * (1 + np.sin(3 * x)) + 0.12 * np.clip(x - 0.3, 0, None)
    line = np.column_stack([x, y, sway * np.sin(4 * x)])
    sizes = fat * (1 - 0.35 * np.clip(np.abs(x) / 0.6 - 0.6, 0, None))
    feet = []
    for at, size in zip(line[1:-1], sizes[1:-1], strict=True):
        if arch < 0.1 or at[1] < 0.35 * arch + 0.02:
            for out in (size, -size):
                feet.append(tube([by(at, 0, 0, 0.5 * out), by(at, 0, -1.15 * size, 0.65 * out)], 0.032))
    end = by(line[-1], 0.5 * fat, 0.02, 0.0)
    # On an arched back, the beads are too far apart to touch, so a spine connects them.
    parts = [fuse(tube(line, 0.7 * sizes))]
    parts += [fuse(ball(at, size), blend=0.05) for at, size in zip(line, sizes, strict=True)]
    parts += [fuse(*feet, blend=0.02), fuse(ball(end, 1.05 * fat), blend=0.02)]
    for k in (1, -1):
        horn = tube([by(end, 0.02, 0.08, 0.04 * k), by(end, 0.06, 0.2, 0.09 * k)], 0.018)
        knob, eye = ball(by(end, 0.06, 0.21, 0.09 * k), 0.03), ball(by(end, 0.075, 0.03, 0.055 * k), 0.032)
        parts.append(fuse(horn, knob, eye, blend=0.008))
    return parts


def _bee(pose: str, rng: Rng) -> list[Part]:
    """Return a bee or bumblebee: furry thorax, ringed abdomen, two pairs of wings."""
    belly, head, span, breast = around(rng, 0.14, 0.20, 1.0, 1.0, 0.19)
    raised, back = _held(rng, (12, 50), (0, 25)) if pose == "fly" else _held(rng, (8, 20), (48, 66))
    rear = [(-0.12, 0.0), (-0.30, 0.0), (-0.50, -0.06), (-0.66, -0.16)]
    rows = (LegRow(0.15, 0.09, 50, 0.28), LegRow(0.05, 0.1, 95, 0.30), LegRow(-0.04, 0.09, 140, 0.36))
    fore = wing([0.08, 0.8 * breast, 0.07], _BLADE * span, raised, back, 0.013)
    hind = wing([-0.02, 0.75 * breast, 0.07], 0.7 * (_BLADE * span), raised - 8, back + 18, 0.013)
    return [
        fuse(ball((0.07, 0.02), [1.1 * breast, breast, breast]), ripple=Ripple(0.008, 0.06)),
        fuse(_ringed(rear, [0.55 * belly, belly, 0.85 * belly, 0.2 * belly], 5, 0.13), blend=0.03),
        fuse(ball((0.31, -0.02), [0.12, 0.15 * head, 0.16 * head]), blend=0.02),
        _eyes([0.33, 0.0, 0.13 * head], [0.07, 0.10, 0.055]),
        _feelers([0.41, 0.05, 0.04], [[0.08, 0.08, 0.05], [0.2, 0.06, 0.1]], 0.017),
        legs(rows, pose, rng, 0.30, 0.030, 1.2, -0.1),
        fuse(*fore, *hind, blend=0.012),
    ]


def _fly(pose: str, rng: Rng) -> list[Part]:
    """Return a fly: large eyes, short antennae, one pair of wings."""
    belly, eye, span = around(rng, 0.14, 1.0, 0.125, 1.0)
    raised, back = _held(rng, (10, 45), (0, 25)) if pose == "fly" else _held(rng, (8, 18), (52, 72))
    rear = [(-0.1, 0.02), (-0.26, 0.01), (-0.42, -0.04), (-0.55, -0.10)]
    proboscis = tube([(0.34, -0.05), (0.37, -0.13)], [0.035, 0.026])
    rows = (LegRow(0.15, 0.1, 48, 0.34), LegRow(0.05, 0.1, 95, 0.36), LegRow(-0.05, 0.1, 140, 0.42))
    wings = wing([0.03, 0.17, 0.08], _BLADE * [1.0, 1.35] * span, raised, back, 0.013)
    return [
        fuse(ball((0.05, 0.03), [0.22, 0.19, 0.19])),
        fuse(_ringed(rear, np.array([0.14, 0.19, 0.15, 0.04]) * belly, 4, 0.09), blend=0.03),
        fuse(ball((0.30, 0.03), [0.11, 0.13, 0.14]), blend=0.02),
        _eyes([0.32, 0.05, 0.115], [0.8 * eye, 1.1 * eye, 0.75 * eye], 25),
        fuse(proboscis, ball((0.375, -0.14), 0.034), blend=0.01),
        _feelers([0.40, 0.06, 0.03], [[0.05, 0.03, 0.02], [0.09, 0.0, 0.04]], 0.018),
        legs(rows, pose, rng, 0.30, 0.024, 1.25, -0.08),
        fuse(*wings, blend=0.012),
    ]


def _grasshopper(pose: str, rng: Rng) -> list[Part]:
    """Return a grasshopper with the knees of its hind legs above its back, or stretched legs if it leaps."""
    tail, high, feeler, head = around(rng, 0.12, 0.52, 0.36, 1.0, 1.0)
    knee, foot = np.array([-0.42, high, 0.20]), np.array([-0.30, -0.24, 0.30])
    if pose == "leap":
        knee, foot = np.array([-0.36, 0.10, 0.22]), np.array([-0.78, -0.30, 0.30])
    thigh = np.array([[0.02, -0.04, 0.07], [-0.08, 0.02, 0.12], by(knee, 0.0, 0.0, 0.13) / 2, knee])
    shin = [knee, by((knee + foot) / 2, 0, 0, 0.01), foot, by(foot, -0.11, 0.0, 0.03)]
    cover = [(0.08, 0.10), (-0.2, 0.09), (-tail - 0.1, 0.03)]
    face = tube([(0.30, 0.08), (0.34, -0.03), (0.33, -0.12)], np.array([0.085, 0.09, 0.05]) * head)
    long = rng.uniform(0.25, 0.7) * feeler
    rows = (LegRow(0.22, 0.06, 40, 0.26), LegRow(0.08, 0.07, 95, 0.26))
    return [
        fuse(_ringed([(0.14, 0), (-0.15, -0.01), (-tail, -0.01)], [0.11, 0.10, 0.045], 6, 0.08, 0.85)),
        fuse(tube(cover, [0.045, 0.05, 0.02], [0.10, 0.08, 0.04]), blend=0.015),
        fuse(tube([(0.05, 0.02), (0.24, 0.03)], [0.13, 0.12], [0.11, 0.10]), blend=0.01),
        fuse(face, blend=0.012),
        _eyes([0.355, 0.085, 0.065], [0.04, 0.05, 0.03]),
        _feelers([0.345, 0.10, 0.03], [[0.5 * long, 0.35 * long, 0.12], [long, 0.42 * long, 0.22]], 0.016),
        pair(tube(thigh, [0.04, 0.065, 0.055, 0.028]), tube(shin, [0.028, 0.022, 0.02, 0.018]), blend=0.01),
        legs(rows, "fly" if pose == "leap" else pose, rng, 0.24, 0.024, 1.3, -0.04),
    ]


def _mantis(pose: str, rng: Rng) -> list[Part]:
    """Return a praying mantis: raised thorax, folded forelegs, a triangular head."""
    neck, belly, reach = around(rng, 0.12, 0.45, 1.0, 0.32)
    tilt = np.deg2rad(rng.uniform(35, 65))
    top = np.array([0.05, 0.02, 0]) + neck * ray(0.0, tilt)
    face = by(top, 0.07, 0.05, 0)
    open_by = 0.09 if pose == "strike" else 0.0
    elbow = by(top, 0.55 * reach, -0.35 * reach + open_by, 0.10)
    wrist = by(elbow, 0.35 * reach + 2 * open_by, reach - 1.5 * open_by, 0.02)
    claw = by(wrist, 0.10 + 2 * open_by, -0.75 * reach + 2.2 * open_by, 0.0)
    arm = [
        tube([by(top, -0.05, -0.06, 0.01), by(top, 0.02, -0.10, 0.06), elbow], [0.04, 0.042, 0.034]),
        tube([elbow, by((elbow + wrist) / 2, 0, 0, 0.02), wrist], [0.036, 0.055, 0.03]),
        tube([wrist, claw], [0.032, 0.014]),
    ]
    rear = [(0.08, 0.02), (-0.25, 0.0), (-0.66, -0.05)]
    cover = tube([(0.05, 0.10), (-0.3, 0.10), (-0.72, 0.0)], [0.03, 0.04, 0.016], [0.06, 0.095, 0.04])
    cheeks = tube([by(face, 0, 0.03, -0.07), face, by(face, 0, 0.03, 0.07)], [0.035, 0.06, 0.035])
    mouth = tube([face, by(face, 0.06, -0.09, 0)], [0.055, 0.02])
    rows = (LegRow(0.04, 0.04, 80, 0.40), LegRow(-0.04, 0.04, 128, 0.46))
    return [
        fuse(_ringed(rear, np.array([0.06, 0.11, 0.03]) * belly, 6, 0.08)),
        fuse(cover, blend=0.015),
        fuse(tube([np.zeros(3), by(top, 0.05, 0.02, 0) / 2, top], [0.055, 0.042, 0.05]), blend=0.02),
        fuse(cheeks, mouth, blend=0.02),
        _eyes(by(face, 0.0, 0.045, 0.095), [0.042, 0.052, 0.042]),
        _feelers(by(face, 0.03, 0.05, 0.02), [[0.1, 0.16, 0.06], [0.14, 0.3, 0.14]], 0.015),
        pair(*arm, blend=0.012),
        legs(rows, pose, rng, 0.34, 0.022, 1.28),
    ]


def _spider(pose: str, rng: Rng) -> list[Part]:
    """Return a spider: two balls, eight legs, palps."""
    belly, reach, front = around(rng, 0.2, 0.25, 0.62, 28.0)
    thick = rng.uniform(0.022, 0.04)
    coat = Ripple(0.005, 0.06) if rng.uniform() < 0.4 else None
    rear = ball((-0.1 - belly, 0.06), [1.2 * belly, 0.9 * belly, belly], pitch(8))
    fang = tube([[0.32, -0.02, 0.05], [0.40, -0.07, 0.05], [0.40, -0.15, 0.04]], [0.05, 0.042, 0.015])
    palp = tube([[0.27, -0.02, 0.09], [0.41, 0.03, 0.15], [0.50, -0.07, 0.14]], 0.8 * thick)
    legs_from_front = zip((front, 68, 108, 150), (1.12, 0.95, 0.9, 1.15), strict=True)
    rows = [LegRow(0.22 - 0.065 * i, 0.10, a, reach * far) for i, (a, far) in enumerate(legs_from_front)]
    return [
        fuse(ball((0.12, 0.01), [0.22, 0.14, 0.18])),
        fuse(rear, blend=0.03, ripple=coat),
        fuse(ball((0.27, 0.03), [0.10, 0.09, 0.11]), blend=0.05),
        pair(ball([0.35, 0.07, 0.04], 0.03), ball([0.33, 0.10, 0.085], 0.022), blend=0.004),
        pair(fang, blend=0.01),
        pair(palp, blend=0.01),
        legs(rows, pose, rng, 0.26, thick, rng.uniform(1.3, 1.6)),
    ]


def _scorpion(pose: str, rng: Rng) -> list[Part]:
    """Return a scorpion: pincers in front, and the sting over the back."""
    radius, claw, reach, wide = around(rng, 0.15, 0.27, 0.13, 0.36, 1.0)
    curl = np.deg2rad(np.linspace(165, rng.uniform(10, 50), 7))
    arc = [-0.36 + radius * np.cos(curl), 0.04 + radius + radius * np.sin(curl) * 1.15, 0 * curl]
    tail = np.vstack([[-0.34, 0.0, 0], [-0.55, 0.04, 0], np.column_stack(arc)])
    sting = tube([tail[-1], by(tail[-1], 0.06, -0.13, 0)], [0.05, 0.014])
    hand = np.array([0.62, 0.0, 0.30])
    arm = np.array([[0.24, 0.0, 0.08], [0.36, 0.06, 0.28], [0.52, 0.02, 0.36], hand])
    pincer = yaw(rng.uniform(-5, 20))
    grip = []
    for side in (1, -1):
        finger = [[0, 0, 0], [claw, 0, side * 0.6 * claw], [2.0 * claw, 0, side * 0.12 * claw + 0.02]]
        grip.append(tube(np.array(finger) @ pincer.T + hand, [0.55 * claw, 0.36 * claw, 0.12 * claw]))
    palm = ball(hand, [1.2 * claw, 0.7 * claw, 0.8 * claw])
    rows = [LegRow(0.18 - 0.1 * i, 0.10, azimuth, reach) for i, azimuth in enumerate((55, 82, 108, 138))]
    return [
        fuse(_ringed([(-0.40, 0), (-0.1, 0.01), (0.28, 0)], [0.07, 0.11, 0.09], 7, 0.12, 1.45 * wide)),
        fuse(_ringed(tail, np.linspace(0.062, 0.05, len(tail)), 6, 0.3), blend=0.02),
        fuse(ball(tail[-1], 0.068), sting, blend=0.01),
        pair(tube(arm, [0.04, 0.036, 0.034, 0.04]), palm, *grip, blend=0.01),
        _eyes([0.24, 0.10, 0.03], 0.022),
        legs(rows, pose, rng, 0.15, 0.026, 1.3),
    ]


def _butterfly(pose: str, rng: Rng) -> list[Part]:
    """Return a butterfly with its wings spread or folded over the back."""
    fore, hind, deep, slim = around(rng, 0.18, 1.0, 1.0, 1.0, 0.052)
    flies = pose == "fly"
    raised, back = _held(rng, (8, 52), (-8, 10)) if flies else _held(rng, (66, 80), (-4, 8))
    tilt = rng.uniform(15, 65) if flies else rng.uniform(0, 15)
    lower = _HIND * hind
    if rng.uniform() < 0.4:  # a swallowtail
        lower[4] = [0.40, -0.80 * hind]
    wings = [
        *wing([0.06, 0.03, 0.025], _FORE * [fore, fore * deep], raised, back, 0.016, 0.15),
        *wing([-0.04, 0.03, 0.025], lower, raised - 3, back, 0.016, 0.15),
    ]
    rear = [(-0.04, 0), (-0.2, 0.0), (-0.44, -0.05)]
    rows = (LegRow(0.09, 0.035, 55, 0.15), LegRow(0.04, 0.035, 95, 0.16), LegRow(-0.01, 0.035, 130, 0.17))
    parts = [
        fuse(tube([(-0.06, 0), (0.05, 0.01), (0.15, 0)], [1.2 * slim, 1.5 * slim, 1.1 * slim])),
        fuse(_ringed(rear, [slim, 1.15 * slim, 0.5 * slim], 5, 0.1), blend=0.02),
        fuse(ball((0.21, 0.01), 1.25 * slim), blend=0.01),
        _eyes([0.235, 0.02, 0.045], 0.032),
        _feelers([0.25, 0.03, 0.02], [[0.14, 0.07, 0.07], [0.30, 0.10, 0.15]], 0.018, club=1.9),
        fuse(*wings, blend=0.012),
        legs(rows, "fly" if flies else "stand", rng, 0.17, 0.019, 1.12, -0.02),
    ]
    return carried(parts, Frame(np.zeros(3), pitch(tilt)))


def _dragonfly(pose: str, rng: Rng) -> list[Part]:
    """Return a dragonfly: a long rod as a tail, and four long spread wings."""
    tail, span, eye, breast = around(rng, 0.13, 0.75, 1.0, 0.085, 1.0)
    raised = rng.uniform(-5, 30) if pose == "fly" else rng.uniform(-4, 8)
    droop, thin = rng.uniform(-0.1, 0.12), 0.042
    rear = [(-0.08, 0.01), (-0.4, 0.5 * droop), (-0.20 - tail, droop)]
    wings = _LONG * [0.85, 1.35] * span
    rows = (LegRow(0.14, 0.05, 45, 0.22), LegRow(0.07, 0.06, 85, 0.22), LegRow(0.0, 0.06, 125, 0.24))
    return [
        fuse(ball((0.03, 0.03), np.array([0.19, 0.13, 0.11]) * breast, pitch(-12))),
        fuse(_ringed(rear, [1.4 * thin, thin, thin], 8, 0.16), blend=0.03),
        fuse(ball((0.25, 0.02), [0.08, 0.09, 0.09]), blend=0.02),
        _eyes([0.27, 0.045, 0.06], [0.9 * eye, eye, 0.9 * eye]),
        fuse(*wing([0.08, 0.13, 0.04], wings, raised, 2, 0.014), blend=0.012),
        fuse(*wing([-0.06, 0.12, 0.04], wings, raised + 4, 14, 0.014), blend=0.012),
        legs(rows, pose, rng, 0.24, 0.020, 1.2, -0.05),
    ]


INSECTS: Mapping[str, BodyPlan] = {
    "ant": FunctionPlan(("stand", "walk"), _ant),
    "bee": FunctionPlan(("fly", "fly", "stand"), _bee),
    "beetle": FunctionPlan(("stand", "walk"), _beetle),
    "butterfly": FunctionPlan(("fly", "fly", "stand"), _butterfly),
    "caterpillar": FunctionPlan(("stand", "walk"), _caterpillar),
    "dragonfly": FunctionPlan(("fly", "stand"), _dragonfly),
    "fly": FunctionPlan(("fly", "stand", "walk"), _fly),
    "grasshopper": FunctionPlan(("stand", "stand", "leap"), _grasshopper),
    "ladybird": FunctionPlan(("stand", "walk"), _ladybird),
    "mantis": FunctionPlan(("stand", "strike"), _mantis),
    "scorpion": FunctionPlan(("stand", "walk"), _scorpion),
    "spider": FunctionPlan(("stand", "walk"), _spider),
}
