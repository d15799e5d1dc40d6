"""Plush toys: a round body, stubby limbs, a great head; sewn together along grooves on some."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from normalgan.animals.chain import Frame, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import Shape, ball, both, by, carried, fuse, mirrored, tube
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors
from normalgan.animals.sweep import Floats, Sweep

HABITS = ("sit", "sit", "stand", "hug", "cheer")
SKULL = np.array([1.0, 0.93, 1.08])  # radii of a head in its own unit


@dataclass(frozen=True, eq=False)
class Toy:
    """What a toy is sewn from, a seat or sole at about y = 0 and about 1 high.

    Args:
        belly: (3,) radii of the body.
        head: half the height of the head.
        limbs: thickness of arms and legs, 1 as usual.
        arms: length of the arms, 1 as usual.
        hands: whether the hands are thicker than the arms.
    """

    belly: tuple[float, float, float] = (0.25, 0.30, 0.26)
    head: float = 0.27
    limbs: float = 1.0
    arms: float = 1.0
    hands: bool = False


def sewn(toy: Toy, features: list[Part], pose: str, rng: Rng) -> list[Part]:
    """Return the toy in a pose, its head with its features on top.

    Args:
        toy: its sizes; an individual's differ.
        features: parts of the face, the unit being half the height of the head.
        pose: sit, stand, hug or cheer; the last two sit or stand.
        rng: for the sizes and how it sits.
    """
    f = factors(rng, 0.12, "belly", "tall", "head", "limbs", "arms")
    depth, half, width = np.array(toy.belly) * [f["belly"], f["tall"], f["belly"]]
    sits = pose == "sit" or (pose != "stand" and rng.uniform() < 0.6)
    thick = 0.10 * toy.limbs * f["limbs"]
    parts = [fuse(ball([0, half, 0], [depth, half, width]))]
    parts.append(fuse(*both(*_leg(depth, half, width, thick, sits, rng)), blend=0.025))
    arms = [_arm(toy, (depth, half, width), 0.85 * thick, f["arms"], pose, rng) for _ in range(2)]
    parts.append(fuse(*arms[0], *(mirrored(shape) for shape in arms[1]), blend=0.025))
    size = toy.head * f["head"]
    chin = Frame(np.array([0.12 * depth, 2 * half + 0.68 * size, 0]), _nod(rng))
    if rng.uniform() < 0.45:
        parts.append(fuse(seam([0, half, 0], [depth, half, width]), blend=0.01, carve=True))
        features = [*features[:1], fuse(seam([0, 0, 0], SKULL), blend=0.03, carve=True), *features[1:]]
    return parts + carried(features, chin, size)


def seam(at: ArrayLike, radii: ArrayLike) -> Sweep:
    """Return the line along the middle of an ellipsoid, to dig."""
    turns = np.linspace(-0.42, 0.62, 17) * np.pi
    ring = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    return tube(np.array(at, float) + 1.01 * ring * np.array(radii, float), 0.008)


def on_skull(aside: float, up: float, out: float = 1.0) -> Floats:
    """Return the point (3,) of the head ``aside`` degrees to the right and ``up`` above its middle."""
    a, e = np.deg2rad(aside), np.deg2rad(up)
    ray = np.array([np.cos(a) * np.cos(e), np.sin(e), np.sin(a) * np.cos(e)])
    point: Floats = ray / np.linalg.norm(ray / SKULL) * out
    return point


def skull(cheeks: float = 0.0) -> list[Part]:
    """Return the bare head, with cheeks of some size."""
    parts = [fuse(ball([0, 0, 0], SKULL), blend=0.05)]
    if cheeks:
        parts.append(fuse(*both(ball([0.35, -0.35, 0.55], cheeks)), blend=0.3))
    return parts


def buttons(aside: float, up: float, radius: float, out: float = 1.0) -> Part:
    """Return a pair of round eyes sewn on."""
    return fuse(*both(ball(on_skull(aside, up, out), radius)), blend=0.02)


def smile(aside: float, up: float, rise: float, out: float = 1.0) -> Part:
    """Return the groove of a mouth, to dig; its corners ``rise`` degrees above its middle."""
    t = np.linspace(-1, 1, 9)
    curve = [on_skull(aside * float(s), up + rise * float(s * s), out) for s in t]
    return fuse(tube(curve, 0.03), blend=0.02, carve=True)


def _nod(rng: Rng) -> Floats:
    turned: Floats = yaw(float(rng.normal(0, 12))) @ pitch(float(rng.uniform(-10, 8)))
    return turned


def _leg(depth: float, half: float, width: float, thick: float, sits: bool, rng: Rng) -> list[Shape]:
    spread = float(rng.uniform(12, 34))
    if not sits:
        hip, sole = np.array([0.0, 0.35 * half, 0.52 * width]), np.array([0.02, -0.16, 0.60 * width])
        return [
            tube([hip, sole], [1.2 * thick, 1.1 * thick]),
            ball(by(sole, 0.05, -0.01, 0.0), [1.6 * thick, thick, 1.2 * thick]),
        ]
    ahead = yaw(-spread) @ np.array([0.85 * depth + float(rng.uniform(0.10, 0.18)), 0.0, 0.0])
    hip, sole = (
        np.array([0.1 * depth, 1.05 * thick, 0.5 * width]),
        np.array([0.0, 1.05 * thick, 0.5 * width]) + ahead,
    )
    foot = ball(by(sole, 0.02, 0.35 * thick, 0), [0.75 * thick, 1.45 * thick, 1.15 * thick], yaw(-spread))
    return [tube([hip, sole], [1.15 * thick, 1.05 * thick]), foot]


def _arm(
    toy: Toy, belly: tuple[float, float, float], thick: float, long: float, pose: str, rng: Rng
) -> list[Shape]:
    depth, half, width = belly
    shoulder = np.array([0.05 * depth, 1.62 * half, 0.66 * width])
    jitter = rng.uniform(-0.05, 0.05, 3)
    way = {"hug": [0.30, -0.02, 0.06], "cheer": [0.04, 0.20, 0.24]}.get(pose, [0.12, -0.20, 0.17])
    hand = shoulder + (np.array(way) + jitter) * toy.arms * long * 1.12
    shapes: list[Shape] = [
        tube([shoulder, (shoulder + hand) / 2 + [0, 0, 0.015], hand], [1.1 * thick, 1.05 * thick, thick])
    ]
    if toy.hands:
        shapes.append(ball(hand, 1.25 * thick))
    return shapes
