"""Legs: a template scaled to the species, folded by the pose, its foot set on the ground."""

import numpy as np

from normalgan.animals.chain import Frame, fold
from normalgan.animals.species import Build, Limb
from normalgan.animals.sweep import Floats, Sweep

BELOW_BELLY = 0.6  # share of the height that longer legs add to


def ground(build: Build) -> float:
    """Return the height of the ground, 0 for legs of the drawn length."""
    return BELOW_BELLY * (1 - build.legs)


def hang(limb: Limb, build: Build, angles: tuple[float, ...]) -> Floats:
    """Return the folded stations, (n + 1, 3), from the uppermost joint; the last one is the sole."""
    rows = np.array(limb.template.rows)
    length = limb.y - ground(build)
    forward = np.append(rows[:, 0], rows[-1, 0]) * length
    height = np.append(rows[:, 1], 0.0)
    across = (limb.foot - limb.z) * (1 - height)
    points = np.column_stack([forward, (height - 1) * length, across])
    return fold(points, limb.template.joints, angles)


def leg(limb: Limb, build: Build, angles: tuple[float, ...], stance: bool, body: Frame, right: bool) -> Sweep:
    """Return one leg.

    Args:
        limb: the pair of legs of which it is one.
        build: the individual.
        angles: of its four joints, degrees from rest.
        stance: stretch or shorten it so that its sole is on the ground.
        body: where the torso is.
        right: on +z.
    """
    rows = np.array(limb.template.rows)
    points = hang(limb, build, angles)
    root = body.place(np.array([[limb.x * build.length, limb.y, limb.z * build.girth]]))[0]
    if stance:
        points[:, 1] *= (ground(build) - root[1]) / points[-1, 1]
    points += root
    widen = np.interp(rows[:, 1], [0.5, 0.9], [build.bone, build.bone**0.5])
    thick = limb.thick * limb.y * widen
    mirror = np.array([1.0, 1.0, 1.0 if right else -1.0])
    sole = (points[-1] - points[-2]) / np.linalg.norm(points[-1] - points[-2])
    if stance:
        sole = np.array([0.0, -1.0, 0.0])
    cut = (points[-1] * mirror, sole * mirror) if limb.template.sole else None
    sides = np.tile([0.0, 0.0, 1.0], (len(rows), 1))
    return Sweep(points[:-1] * mirror, rows[:, 2] * thick, rows[:, 3] * thick, sides, cut)


def shoulder_blade(limb: Limb, build: Build, body: Frame, right: bool) -> Sweep:
    """Return the flat muscle that runs from the point of the shoulder up and back to the withers."""
    x, size = limb.x * build.length, limb.y * limb.thick
    sign = 1.0 if right else -1.0
    points = np.array(
        [
            [x, limb.y, limb.z * build.girth * sign],
            [x - 0.07, limb.y + 0.14, (0.85 * limb.z + 0.01) * build.girth * sign],
            [x - 0.13, limb.y + 0.25, 0.52 * limb.z * build.girth * sign],
        ]
    )
    radii, widths = np.array([0.13, 0.115, 0.075]) * size, np.array([0.085, 0.060, 0.040]) * size
    return Sweep(body.place(points), radii, widths, np.tile(body.rotation[:, 2], (3, 1)))
