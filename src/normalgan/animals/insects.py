"""What insects are made of: jointed legs, feelers, eyes, rings, wings; a body is about 1 long."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from normalgan.animals.chain import Frame, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, ball, both, fuse, mirrored, roll, tube
from normalgan.animals.plan import Rng
from normalgan.animals.plate import Plate
from normalgan.animals.shapes import hinge
from normalgan.animals.sweep import Floats, Sweep

LegRow = tuple[float, float, float, float]
"""Where a pair of legs grows and goes: x, half the distance apart, degrees from straight ahead, reach."""
OUT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # columns: to the right, ahead, up


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

    Walking ones go by tripods: neighbours swing in turn (Wilson, "Insect walking", 1966); flying ones hang.

    Args:
        rows: pairs from front to back.
        pose: walk, fly, or whatever else stands.
        rng: for the swing.
        ground: how far below the body's axis the ground is.
        thick: radius of the femur.
        bent: length of the leg over the distance it bridges.
        at: height at which they grow.
    """
    swing = float(rng.uniform(9, 17)) * (1 if rng.uniform() < 0.5 else -1)
    shapes: list[Shape] = []
    for i, (x, z, azimuth, reach) in enumerate(rows):
        for side in (0, 1):
            phase = 1 if (i + side) % 2 else -1
            angle = azimuth + float(rng.uniform(-4, 4)) + (phase * swing if pose == "walk" else 0.0)
            lift = 0.22 * ground if pose == "walk" and phase * swing > 0 else 0.0
            far, low = (0.55 * reach, 0.9 * ground) if pose == "fly" else (reach, ground - lift)
            away = np.array([np.cos(np.deg2rad(angle)), 0.0, np.sin(np.deg2rad(angle))])
            hip = np.array([x, at, z])
            foot = hip + far * away
            foot[1] = -low
            length = bent * float(np.linalg.norm(foot - hip))
            knee = hinge(hip, foot, 0.46 * length, 0.54 * length, (0.0, 1.0, 0.0))
            leg = _leg(hip, knee, foot, foot + 0.16 * far * away, thick)
            shapes.append(leg if side == 0 else mirrored(leg))
    return fuse(*shapes, blend=0.6 * thick)


def _leg(hip: Floats, knee: Floats, foot: Floats, toe: Floats, thick: float) -> Sweep:
    inner = hip * np.array([1.0, 1.0, 0.4])
    points = [inner, hip, (hip + knee) / 2, knee, (knee + foot) / 2, foot, toe]
    return tube(points, np.array([1.1, 1.05, 1.15, 0.85, 0.7, 0.55, 0.5]) * thick)


def feelers(base: ArrayLike, bends: Sequence[ArrayLike], thick: float, club: float = 0.8) -> Part:
    """Return a pair of antennae.

    Args:
        base: of the right one.
        bends: the points through which it goes on, as offsets from the base.
        thick: radius at the base.
        club: radius at the tip over that.
    """
    start = np.array(base, float)
    points = [start, *(start + np.array(step, float) for step in bends)]
    radii = np.linspace(1, 0.8, len(points)) * thick
    radii[-1] = club * thick
    return fuse(*both(tube(points, radii)), blend=0.01)


def eyes(at: ArrayLike, radii: ArrayLike, turn: float = 0.0) -> Part:
    """Return a pair of faceted eyes, seen as smooth."""
    return fuse(*both(ball(at, radii, yaw(turn))), blend=0.01)


def ringed(points: ArrayLike, radii: ArrayLike, rings: int, depth: float, flat: float = 1.0) -> Sweep:
    """Return a tube with ``rings`` rings, ``depth`` the part of the radius by which it narrows between them.

    Args:
        points: the curve's stations.
        radii: at these.
        rings: how many.
        depth: from 0 to 1.
        flat: its width over its height.
    """
    stations, sizes = np.array(points, float), np.array(radii, float)
    knots = np.linspace(0, 1, len(stations))
    at = np.linspace(0, 1, 4 * rings + 1)
    curve = CubicSpline(knots, np.column_stack([stations, sizes]))(at)
    fat = np.maximum(curve[:, 3], 0.02) * (1 - depth * np.abs(np.cos(np.pi * rings * at)) ** 3)
    return tube(curve[:, :3], fat, fat * flat)


def wing(
    hinge_at: ArrayLike,
    outline: Sequence[tuple[float, float]],
    raised: float,
    back: float,
    thick: float,
    bow: float = 0.0,
) -> tuple[Shape, ...]:
    """Return a pair of wings.

    Args:
        hinge_at: where the right one is hinged.
        outline: (out, ahead) corners of a smooth outline, the hinge at the origin.
        raised: degrees above level; 90 is straight up.
        back: degrees swept back.
        thick: half the thickness.
        bow: curvature across, positive arched upwards.
    """
    corners = np.array([*outline, outline[0]], float)
    at = np.linspace(0, len(outline), 6 * len(outline) + 1)[:-1]
    smooth = CubicSpline(np.arange(len(corners)), corners, bc_type="periodic")(at)
    frame = Frame(np.array(hinge_at, float), roll(raised) @ yaw(-back) @ OUT)
    return both(Plate(smooth, frame, thick, bow=(-bow, -bow)))


def held(
    pose: str,
    rng: Rng,
    raised: tuple[float, float],
    back: tuple[float, float],
    raised_at_rest: tuple[float, float],
    back_at_rest: tuple[float, float],
) -> tuple[float, float]:
    """Draw how high and how far back wings are held, in degrees."""
    up, sweep = (raised, back) if pose == "fly" else (raised_at_rest, back_at_rest)
    return float(rng.uniform(*up)), float(rng.uniform(*sweep))
